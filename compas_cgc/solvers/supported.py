"""A start that supports alone make: the plate over them, which bulges to the side that is drawn."""

from __future__ import annotations

from typing import Callable
from typing import Optional

import numpy as np

from ..discrete import vertex_normals
from ..model.problem import CGCProblem
from ..model.result import Solution
from ..model.roles import FIXED
from .drawn_side import is_drawn_below
from .projection.plate import relaxed

__all__ = ["solved_from_supports"]

FACING = 0.5  # length of the mean of the normals, from which a drawing is one of heights over a plan
OFF = 1e-3  # of its size, that a drawing of its own lies off the plate
DIGITS = 12  # of coordinates, against the size
MOST = 3000  # vertices, for which this takes seconds


def solved_from_supports(problem: CGCProblem, solve: Callable[[CGCProblem], Solution]) -> Optional[Solution]:
    """Return the solution from the plate over the supports, to the side that is drawn.

    Along straight edges that are held a sine or a paraboloid has K < 0 or none where K > 0 is asked for, and a search that keeps to
    its shape puts folds there. What such a drawing says is the side; all else follows from the supports and K.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets, of which none is negative.
    solve
        Solves the problem with the plate drawn.

    Returns
    -------
    Solution or None
        None with constraints, where the drawing is the plate or stands upright, on large meshes, and unless K > 0 somewhere.
    """
    asked = problem.targets[problem.asked]
    if problem.goals or len(problem.vertices) > MOST or not problem.real_faces.all() or not (problem.roles == FIXED).any():
        return None
    if not (asked >= 0.0).all() or not (asked > 0.0).any():
        return None
    normals = vertex_normals(problem.vertices, problem.faces).mean(axis=0)
    if not normals @ normals > FACING**2:
        return None
    size, free = float(np.ptp(problem.vertices, axis=0).max()), problem.roles != FIXED
    # Without the last digits of what is drawn, which a flat sheet would take for a shape.
    shape = np.where(free[:, None], size * np.round(relaxed(problem) / size, DIGITS), problem.vertices)
    if not np.abs(shape - problem.vertices).max() > OFF * size:
        return None
    plate = problem.with_vertices(shape)
    return solve(plate.flipped() if is_drawn_below(problem) else plate)
