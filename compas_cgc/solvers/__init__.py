"""Solvers: a problem in, the surface with the curvature asked for out."""

from __future__ import annotations
