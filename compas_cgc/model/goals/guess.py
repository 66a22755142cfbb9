"""Initial guess of unknown K, and the factors on it that signs and bounds allow."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ...discrete import face_areas
from ...discrete import face_normals
from ...errors import ProblemError
from ..constraints import CROWN
from ..constraints import Height
from ..problem import CGCProblem
from ..roles import FIXED
from .binding import UnknownConstant
from .binding import support_height
from .binding import unknown_constants
from .inequalities import Above
from .inequalities import Clearance
from .measures import length
from .wholes import Area
from .wholes import Length
from .wholes import Rise
from .wholes import Volume

__all__ = ["allowed", "drawn_constant", "factors", "guessed"]

LOW_RISE = 0.1  # rise over radius of a cap whose goals give no height; gentle, so that every plan can have it
RISE_OVER_MEAN_HEIGHT = 1.6  # rise of a cap over its mean height (volume over plan area); 2 for shallow caps, 1.5 for half spheres


def guessed(problem: CGCProblem) -> CGCProblem:
    """Return the problem with an initial guess for unknown K.

    The guess is the K of a spherical cap with the height that the goals imply, or else the given target.

    Raises
    ------
    ProblemError
        If no factor on drawn values keeps all of them within their bounds.
    """
    unknown = unknown_constants(problem)
    if not unknown:
        return problem
    targets = problem.targets.copy()
    K = _cap(problem)
    for constant in unknown:
        own = np.any([problem.region_vertices(region) for region in constant.regions], axis=0)
        given = targets[own & np.isfinite(targets)]
        if K > 0.0 and constant.is_factor and constant.regions[0] not in problem.laws:
            targets[own] *= K / np.abs(given).mean()
        elif K > 0.0:
            targets[own] = -K if len(given) and given.mean() < 0.0 else K
        targets[own & ~np.isfinite(targets)] = given.mean() if len(given) else 0.0
    return allowed(replace(problem, targets=targets))


def allowed(problem: CGCProblem) -> CGCProblem:
    """Return the problem with drawn values of unknown K whose signs and sizes its goals allow.

    Raises
    ------
    ProblemError
        If no factor on drawn values keeps all of them within their bounds.
    """
    targets = problem.targets.copy()
    for constant in unknown_constants(problem):
        for region in constant.regions:
            own = problem.region_vertices(region)
            targets[own] = targets[own] if constant.goal.sign is None else constant.goal.sign * np.abs(targets[own])
        low, high = factors(replace(problem, targets=targets), constant)
        if not low <= high:
            regions = f"region{'s' * constant.is_factor} {', '.join(map(str, constant.regions))}"
            raise ProblemError([f"K of {regions} cannot be {constant.goal.words}; draw values of that sign, or change the bounds"])
        own = np.any([problem.region_vertices(region) for region in constant.regions], axis=0)
        targets[own] *= min(max(1.0, low), high)
    return replace(problem, targets=targets)


def factors(problem: CGCProblem, constant: UnknownConstant) -> tuple[float, float]:
    """Return the least and the largest factor on the drawn values of an unknown constant that its bounds allow."""
    low, high = 0.0, math.inf
    for region in constant.regions:
        drawn = drawn_constant(problem, region)
        if region in problem.laws or not np.isfinite(drawn) or drawn == 0.0:
            continue
        ends = sorted([constant.goal.least / drawn, constant.goal.largest / drawn])
        low, high = max(low, ends[0]), min(high, ends[1])
    return low, high


def drawn_constant(problem: CGCProblem, region: int) -> float:
    """Return the K that is drawn in a region, NaN without any [1/L^2]; vertices on its rim may have that of another region."""
    within = problem.region_vertices(region)
    inside = within & problem.asked
    drawn = problem.targets[inside if inside.any() else within]
    return float(drawn[0]) if len(drawn) else math.nan


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
