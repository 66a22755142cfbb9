"""Sparse linear systems: one interface, a backend per file."""

from __future__ import annotations

from .nearby import nearly_solved
from .ordering import nested_dissection
from .solvers import BACKENDS
from .solvers import LinearSolver
from .solvers import SingularMatrixError
from .solvers import factorise
from .solvers import linear_solver

__all__ = ["BACKENDS", "LinearSolver", "SingularMatrixError", "factorise", "linear_solver", "nearly_solved", "nested_dissection"]
