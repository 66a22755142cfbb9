"""The side that a drawing bulges to, or a goal asks for, where they say one."""

from __future__ import annotations

import math

import numpy as np

from ..discrete import face_areas
from ..discrete.mean import mean_curvature
from ..discrete.normals import vertex_normals
from ..model.goals.binding import held_by_newton
from ..model.goals.wholes import Rise
from ..model.problem import CGCProblem
from .constants import SIDE_SHARE
from .evened import taut

__all__ = ["hangs", "is_drawn_below"]

BENT = 0.1  # mean curvature over √K below which a bowl is not drawn; a tenth of that of a sphere with this K, drawing errors bend less


def hangs(problem: CGCProblem) -> bool:
    """Return whether a goal asks for a surface below its supports, which Newton's method bulges to along opposite normals."""
    return held_by_newton(problem) and any(isinstance(goal, Rise) and goal.rise < 0.0 for goal in problem.goals)


def is_drawn_below(problem: CGCProblem) -> bool:
    """Return whether a drawing that is held all round lies to the side away from its normals, where K > 0 would bulge along them.

    Parameters
    ----------
    problem
        Held all round, K > 0 where it is asked for.
    """
    K, asked = float(problem.targets[problem.asked].mean()), problem.asked
    bent = float(np.mean(mean_curvature(problem.vertices, problem.faces)[asked]))
    if not bent < -BENT * math.sqrt(K):
        return False
    # A rim that sags says nothing: what counts is what lies under the surface that is taut over it.
    away = np.einsum("ij,ij->i", problem.vertices - taut(problem), vertex_normals(problem.vertices, problem.faces))
    rise = float(face_areas(problem.vertices, problem.faces).sum()) * math.sqrt(K) / (4.0 * math.pi)
    return float(np.mean(away[asked])) < -SIDE_SHARE * rise
