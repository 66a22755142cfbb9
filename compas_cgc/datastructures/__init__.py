"""CGCMesh and the result of a solve."""

from __future__ import annotations

from .cgcmesh import CGCMesh
from .solve_result import SolveResult

__all__ = ["CGCMesh", "SolveResult"]
