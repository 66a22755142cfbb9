"""Old functions: what scripts use of them goes on working, with a warning."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from collections.abc import Sequence
from dataclasses import replace
from typing import Any
from typing import Optional
from typing import Union

from .datastructures import SolveResult
from .model.constraints import Constraint
from .model.problem import CGCProblem
from .model.problem import Names
from .model.recorder import Callback
from .solvers.run import solve

__all__ = ["flip", "set_creases", "set_supports", "set_target", "solve_problem"]


def solve_problem(
    problem: CGCProblem,
    method: str = "auto",
    settings: Any = None,
    callback: Callback = None,
    constraints: Iterable[Constraint] = (),
    names: Optional[Names] = None,
) -> SolveResult:
    """Solve a problem; :func:`compas_cgc.solve` does it."""
    _warn("solve_problem", "compas_cgc.solve")
    named = problem if names is None else replace(problem, names=names)
    return solve(named, method=method, settings=settings, constraints=constraints, callback=callback)


def set_supports(problem: CGCProblem, supports: Union[str, Iterable[int]]) -> CGCProblem:
    """Fix vertices; :meth:`CGCProblem.with_supports` does it."""
    _warn("set_supports", "CGCProblem.with_supports")
    return problem.with_supports(supports)


def set_creases(problem: CGCProblem, creases: Iterable[Sequence[int]]) -> CGCProblem:
    """Let the surface fold along edges; :meth:`CGCProblem.with_creases` does it."""
    _warn("set_creases", "CGCProblem.with_creases")
    return problem.with_creases(creases)


def set_target(problem: CGCProblem, K: float, region: Optional[int] = None) -> CGCProblem:
    """Ask for a Gaussian curvature; :meth:`CGCProblem.with_targets` does it."""
    _warn("set_target", "CGCProblem.with_targets")
    return problem.with_targets(K, region=region)


def flip(problem: CGCProblem) -> CGCProblem:
    """Turn all faces over; :meth:`CGCProblem.flipped` does it."""
    _warn("flip", "CGCProblem.flipped")
    return problem.flipped()


def _warn(old: str, new: str) -> None:
    warnings.warn(f"{old} is now {new}; the old name will go", DeprecationWarning, stacklevel=3)
