"""Initial guess of an unknown K."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ...discrete import face_areas
from ...discrete import face_normals
from ..constraints import CROWN
from ..constraints import Height
from ..problem import CGCProblem
from ..roles import FIXED
from .binding import support_height
from .binding import unknown_regions
from .inequalities import Above
from .inequalities import Clearance
from .measures import length
from .wholes import Area
from .wholes import Length
from .wholes import Rise
from .wholes import Volume

__all__ = ["guessed"]

LOW_RISE = 0.1  # rise over radius of a cap whose goals give no height
RISE_OVER_MEAN_HEIGHT = 1.6  # rise of a cap over its mean height (volume / plan area)


def guessed(problem: CGCProblem) -> CGCProblem:
    """Return the problem with an initial guess for unknown K.

    The guess is the K of a spherical cap with the height that the goals imply, or else the given target.
    """
    unknown = unknown_regions(problem)
    if not unknown:
        return problem
    targets = problem.targets.copy()
    K = _cap(problem)
    for region in unknown:
        own = problem.region_vertices(region)
        given = targets[own & np.isfinite(targets)]
        sign = -1.0 if len(given) and given.mean() < 0.0 else 1.0
        if K > 0.0:
            targets[own] = sign * K
        targets[own & ~np.isfinite(targets)] = given.mean() if len(given) else 0.0
    return replace(problem, targets=targets)


def _cap(problem: CGCProblem) -> float:
    """Return K of the spherical cap over the plan area with the height that the goals imply; zero if they imply none."""
    faces = problem.faces[problem.real_faces]
    plan = float(np.abs((face_normals(problem.vertices, faces)[:, 2] * face_areas(problem.vertices, faces)).sum()))
    if plan <= 0.0 or not (problem.roles == FIXED).any():
        return 0.0
    base, rises = support_height(problem), [0.0]
    for goal in problem.goals:
        if isinstance(goal, Rise):
            rises.append(abs(goal.rise))
        elif isinstance(goal, Height) and isinstance(goal.vertices, str) and goal.vertices == CROWN:
            rises.append(abs(goal.height - base))
        elif isinstance(goal, Volume):
            level = base if goal.level is None else goal.level
            rises.append(RISE_OVER_MEAN_HEIGHT * max(0.0, goal.volume / plan - (base - level)))
        elif isinstance(goal, Area):
            rises.append(math.sqrt(max(0.0, goal.area - plan) / math.pi))
        elif isinstance(goal, Length):
            flat = length(problem.vertices * [1.0, 1.0, 0.0], np.asarray(goal.vertices))
            rises.append(math.sqrt(0.375 * flat * max(0.0, goal.length - flat)))
        elif isinstance(goal, (Height, Above, Clearance)):
            rises.append(abs(goal.height - base))
    radius = math.sqrt(plan / math.pi)
    return _cap_curvature(max(rises) or LOW_RISE * radius, radius) if len(rises) > 1 else 0.0


def _cap_curvature(rise: float, radius: float) -> float:
    return (2.0 * rise / (rise**2 + radius**2)) ** 2
