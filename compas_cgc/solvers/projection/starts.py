"""The shapes that a search may set out from, the most promising first."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.sparse.linalg import ArpackError

from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from .initial_guess import flat_share
from .initial_guess import flat_vertices
from .initial_guess import seeded
from .iterate import Point
from .modes import bending_modes
from .settings import ProjectionSettings
from .system import System
from .vectors import dot
from .vectors import norm

__all__ = ["is_flat", "starts"]

NEARLY = 0.05  # residual, against the curvature asked for, of a drawing that is taken as it is
FLAT_SHARE = 0.1  # part of the curvature asked for in flat places above which a seed is needed
AMPLITUDES = 0.02 * 1.25 ** np.arange(17)  # of a mode, against the size of the mesh
OTHER_SIDE = 1.5  # how much dearer a start is on the side away from the drawing
CANDIDATES = 4  # of which the move to the equations is worked out
DEAREST = 3.0  # a start, against the cheapest, that is worth a try
UNSOLVED = 0.5  # part of the right side that no move accounts for, from which a start is hopeless, such as a flat one
ROUGH = 1e-2  # residual of the linear system for that


class _Candidate(NamedTuple):
    point: Point
    factor: float  # on its cost


def starts(system: System, equations: CurvatureEquations, drawing: Point, settings: ProjectionSettings) -> list[Point]:
    """Return the drawing, and shapes bent from the fairest surface through the supports, the cheapest to finish first.

    The cost is the metric length of the least move that fulfils the linear equations. Where the
    drawing is nearly there, or its shape is to be kept and has curvature, it is the only start.
    """
    flat = is_flat(system, equations, drawing)
    seed = _seeded(system, equations, drawing, settings.seed_height) if flat and settings.seed_height > 0.0 else None
    drawing = system.at(system.settled(drawing.vertices), equations)
    if settings.seed_height == 0.0 or system.missing(drawing, equations) <= NEARLY or (system.keep == "shape" and not flat):
        return [drawing]
    candidates = [_Candidate(drawing, 1.0)]
    if seed is not None:
        candidates.append(_Candidate(seed, 1.0))
    plate = system.at(system.settled(system.fairness.relaxed()), equations)
    candidates += [_Candidate(plate, 1.0), *_bent(system, equations, plate, drawing)]
    candidates = [one for one in candidates if not is_flat(system, equations, one.point)] or candidates
    best = sorted(candidates, key=lambda one: one.factor * system.missing(one.point, equations))[:CANDIDATES]
    costs = [one.factor * _cost(system, equations, one.point) for one in best]
    order = np.argsort(costs, kind="stable")
    return [best[k].point for k in order if costs[k] <= DEAREST * costs[order[0]]]


def _bent(system: System, equations: CurvatureEquations, plate: Point, drawing: Point) -> list[_Candidate]:
    lacking = -plate.residual
    signs = np.where(lacking >= 0.0, 1.0, -1.0)
    try:
        modes = bending_modes(system, equations, plate.vertices, lacking)
    except ArpackError:
        return []
    found = []
    for mode in modes:
        side = dot(mode.ravel(), (drawing.vertices - plate.vertices).ravel())
        for sign in (1.0, -1.0):
            trials = [system.at(plate.vertices + sign * amplitude * system.size * mode, equations) for amplitude in AMPLITUDES]
            brought = [abs(dot(signs, point.residual)) for point in trials]
            point = trials[int(np.argmin(brought))]
            point = system.at(system.settled(point.vertices), equations)
            away = sign * side < 0.0 if side != 0.0 else sign < 0.0
            found.append(_Candidate(point, OTHER_SIDE if away else 1.0))
    return found


def is_flat(system: System, equations: CurvatureEquations, point: Point) -> bool:
    """Return whether a shape is flat where much of the curvature is asked for."""
    return flat_share(point.vertices, system.faces, system.wanted(point, equations)) > FLAT_SHARE


def _cost(system: System, equations: CurvatureEquations, point: Point) -> float:
    linear = system.linearised(point, equations)
    found = linear.solver.cheapest(linear.right, ROUGH)
    if not norm(found.residual) <= UNSOLVED * norm(linear.right):
        return math.inf
    move = found.move
    return math.sqrt(max(0.0, dot(move, linear.solver.metric.times(move))))


def _seeded(system: System, equations: CurvatureEquations, point: Point, highest: float) -> Point:
    """Return the shape with a low dome or saddle where it is flat."""
    rows, targets = system.rows, equations.targets[system.rows]
    wanted = system.wanted(point, equations)

    def defects(vertices: FloatArray) -> FloatArray:
        residual, areas = equations.measure(vertices)
        result = np.zeros(len(vertices))
        result[rows] = residual + targets * areas
        return result

    wanted = np.where(flat_vertices(point.vertices, system.faces, wanted), wanted, 0.0)
    shape = seeded(point.vertices, system.faces, system.columns, system.fairness.plate, wanted, defects, highest)
    return system.at(system.settled(shape), equations)
