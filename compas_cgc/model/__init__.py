"""Problem, constraints, goals, checks and results."""

from __future__ import annotations
