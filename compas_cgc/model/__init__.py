"""What is asked of a mesh, what keeps it from being solved, and what a solve returns."""

from __future__ import annotations
