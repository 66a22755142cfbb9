"""The ways that are tried from a start to the targets."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from .gauss_newton import Taken
from .gauss_newton import descend
from .gauss_newton import in_stages
from .initial_guess import flat_vertices
from .initial_guess import seeded
from .iterate import Point
from .messages import enclosed_negative
from .settings import ProjectionSettings
from .system import System

__all__ = ["ways"]

FLAT_SHARE = 0.1  # part of the curvature asked for in flat places above which a seed is needed
IMPATIENT = 0.5  # what a few steps must make of the merit where the problem is over-determined
LESS, MORE = 0.5, 2.5  # other smoothness to try, against the one asked for


def ways(system: System, equations: CurvatureEquations, start: Point, settings: ProjectionSettings) -> Iterator[Taken]:
    """Take steps straight to the targets and, should that stall, in other ways from the start again."""
    if settings.seed_height > 0:
        start = _seeded(system, equations, start, settings.seed_height)
    start = system.at(system.settled(start.vertices), equations)
    if enclosed_negative(system, equations.targets):
        # Over-determined: to insist on it would crumple the surface.
        yield from descend(system, equations, start, IMPATIENT)
        return
    yield from descend(system, equations, start)
    if settings.retry:
        yield from descend(system.smoother(LESS), equations, start)
        smooth = system.smoother(MORE)
        yield from descend(smooth, equations, start)
        yield from in_stages(smooth, equations.targets, start.vertices)


def _seeded(system: System, equations: CurvatureEquations, start: Point, highest: float) -> Point:
    rows, targets = system.rows, equations.targets[system.rows]
    wanted = np.zeros(len(start.vertices))
    wanted[rows] = targets * start.areas
    flat = flat_vertices(start.vertices, system.faces, wanted)
    if not np.abs(wanted[flat]).sum() > FLAT_SHARE * np.abs(wanted).sum():
        return start

    def defects(vertices: FloatArray) -> FloatArray:
        residual, areas = equations.measure(vertices)
        result = np.zeros(len(vertices))
        result[rows] = residual + targets * areas
        return result

    wanted = np.where(flat, wanted, 0.0)
    shape = seeded(start.vertices, system.faces, system.columns, system.fairness.plate, wanted, defects, highest)
    return system.at(shape, equations)
