"""Sparse linear systems: one interface, a backend per file."""

from __future__ import annotations

from .ordering import nested_dissection
from .solvers import BACKENDS
from .solvers import LinearSolver
from .solvers import SingularMatrixError
from .solvers import factorise
from .solvers import linear_solver

__all__ = ["BACKENDS", "LinearSolver", "SingularMatrixError", "factorise", "linear_solver", "nested_dissection"]
