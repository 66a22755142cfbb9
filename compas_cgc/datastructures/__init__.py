"""The mesh that designers work with, and what a solve makes of it."""

from __future__ import annotations

from .cgcmesh import CGCMesh
from .solve_result import SolveResult

__all__ = ["CGCMesh", "SolveResult"]
