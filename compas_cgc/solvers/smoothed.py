"""A start that is smooth: the surface that was found, with its waves and its errors of K taken out by fitted polynomials."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Callable
from typing import Optional

import numpy as np

from ..discrete import vertex_areas
from ..discrete.arrays import FloatArray
from ..linalg.work import is_spent
from ..linalg.work import until_spent
from ..model.goals.binding import bind
from ..model.problem import CGCProblem
from ..model.result import Solution
from .projection.initial_guess import flat_share
from .projection.messages import enclosed_negative
from .projection.plate import relaxed
from .projection.projector import project
from .projection.settings import ProjectionSettings
from .projection.smooth_shape import smooth_shape
from .projection.system import FLAT_SHARE
from .projection.system import System

__all__ = ["is_drawn", "solved_as_drawn", "solved_smoothed", "solved_turned"]

WEIGHTS, ROUNDS = (0.1, 1.0, 10.0, 100.0, 1000.0, 1e4), 4  # of K against waves, one after the other, and steps for each
FEWEST, MOST = 12, 6000  # vertices with K, for polynomials to tell a smooth shape, and for that to take seconds only


def solved_smoothed(problem: CGCProblem, found: FloatArray, solve: Callable[[CGCProblem], Solution]) -> Optional[Solution]:
    """Return the solution from what was found, smoothed.

    The equations of angle defects tell nothing of waves, and once a search has put some into a surface none of its steps takes them
    out again. Polynomials fitted around the vertices do tell, and the surface that is smooth by them has nearly the K asked for.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets.
    found
        ``(n, 3)`` vertices of a surface that is rough, or was not arrived at [L].
    solve
        Solves the problem with the smooth surface drawn.

    Returns
    -------
    Solution or None
        None where the mesh is too small or large, with constraints or over-determined, or where it takes more work than is allowed.
    """
    if problem.goals or not FEWEST <= int(problem.asked.sum()) <= MOST or not np.isfinite(found).all():
        return None
    local, frame = problem.with_vertices(found).local()
    system = System(local, ProjectionSettings(keep="shape"), bind(local, ()))
    if enclosed_negative(system, local.targets):
        return None
    shapes = list(until_spent(_shapes(system, local)))
    if is_spent():
        return None
    shape = problem.vertices.copy()
    shape[system.columns] = frame.to_model([local.vertices, *shapes][-1][system.columns])
    return solve(problem.with_vertices(shape))


def is_drawn(problem: CGCProblem) -> bool:
    """Return whether a drawing has a shape, and one that can be smoothed."""
    if problem.goals or len(problem.vertices) > MOST:
        return False
    areas = vertex_areas(problem.vertices, problem.faces)
    return flat_share(problem.vertices, problem.faces, areas / max(areas.sum(), np.finfo(float).tiny)) < FLAT_SHARE


def solved_as_drawn(problem: CGCProblem, solve: Callable[[CGCProblem], Solution]) -> Optional[Solution]:
    """Return the solution from the drawing, smoothed where it has a shape.

    From that as it is the first search has set out already, and it would come to the same surface again.

    Parameters
    ----------
    problem, solve
        As for :func:`solved_smoothed`.

    Returns
    -------
    Solution or None
        None where it takes more work than is allowed.
    """
    found = solved_smoothed(problem, problem.vertices, solve) if is_drawn(problem) else None
    return solve(problem) if found is None and not is_spent() else found


def solved_turned(problem: CGCProblem, found: FloatArray, solve: Callable[[CGCProblem], Solution]) -> Optional[Solution]:
    """Return the solution from what was found, turned over about the plate through the supports and smoothed.

    Columns at uneven heights may carry a bowl where a dome through them has tips, or the other way round.

    Parameters
    ----------
    problem, found, solve
        As for :func:`solved_smoothed`.

    Returns
    -------
    Solution or None
        None as there, and unless K > 0 is asked for everywhere: of a saddle no side is the other one.
    """
    if problem.goals or not (problem.targets[problem.asked] > 0.0).all():
        return None
    turned = project(problem.with_vertices(2.0 * relaxed(problem) - found), settings=ProjectionSettings(keep="plan", retry=False))
    return solved_smoothed(problem, turned.vertices, solve) if turned.status == "converged" else None


def _shapes(system: System, local: CGCProblem) -> Iterator[FloatArray]:
    """Pass on smoother and smoother shapes (n, 3)."""
    for taken in smooth_shape(system, system.equations(local.targets), local.vertices, WEIGHTS, ROUNDS):
        yield taken.vertices
