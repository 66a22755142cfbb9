"""The ways that are tried from a start to the targets."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Optional

import numpy as np

from ...discrete.jacobian import CurvatureEquations
from .gauss_newton import Taken
from .gauss_newton import descend
from .gauss_newton import in_stages
from .iterate import Point
from .measure import FINISH
from .measure import smoothed
from .messages import enclosed_negative
from .sequential import NEAR
from .sequential import Reached
from .sequential import approach
from .settings import ProjectionSettings
from .starts import starts
from .system import System
from .trust_region import refine

__all__ = ["ways"]

IMPATIENT = 0.5  # what a few steps must make of the merit where the problem is over-determined
CLOSE = 0.3  # residual, against the curvature asked for, from which least-norm steps go on
SMOOTHER = (1.0, 0.5, 2.5)  # times the smoothness, for least-norm steps
TRIED = 2  # starts whose results are compared


def ways(system: System, equations: CurvatureEquations, start: Point, settings: ProjectionSettings, warm: bool) -> Iterator[Taken]:
    """Take steps to the fairest shape and, should that stall, in other ways from the start again.

    A warm start is gone on from; others are compared with starts of our own. The smooth measure is turned to once
    the surface is fair by angle defects: only then do fits tell the layout of the mesh from wrinkles.
    """
    tried = [system.at(system.settled(start.vertices), equations)] if warm else starts(system, equations, start, settings)
    if enclosed_negative(system, equations.targets):
        # Over-determined: to insist on it would crumple the surface.
        yield from descend(system, equations, tried[0], IMPATIENT)
        return
    reached = yield from _fairest(system, equations, tried[:TRIED])
    if reached is None and settings.retry:
        others = starts(system, equations, start, settings) if warm else tried[TRIED:]
        reached = yield from _fairest(system, equations, others)
    if reached is None and settings.retry:
        reached = yield from _nearest(system, equations, tried[0])
        system = system.keeping("shape")
    if reached is None:
        return
    reached = yield from refine(system, equations, reached)
    if settings.measure == "smooth":
        yield from smoothed(system, equations, reached)
    else:
        yield from descend(system, equations, reached.point, patience=FINISH)


def _fairest(system: System, equations: CurvatureEquations, tried: list[Point]) -> Iterator[Taken]:
    """Approach the equations from several starts; return the one that ends with the least energy, if any."""
    best: Optional[Reached] = None
    least = 0.0
    for point in tried:
        reached = yield from approach(system, equations, point)
        if NEAR < system.missing(reached.point, equations) <= CLOSE:
            reached = yield from _closed(system, equations, reached)
        if system.missing(reached.point, equations) > NEAR:
            continue
        energy = system.fairness.energy(reached.point.vertices)[0]
        if best is None or energy < least:
            best, least = reached, energy
    return best


def _closed(system: System, equations: CurvatureEquations, reached: Reached) -> Iterator[Taken]:
    """Take least-norm steps until the equations are near enough."""
    here = reached.point
    for taken in descend(system, equations, here):
        here = system.at(taken.vertices, equations)
        yield taken._replace(settled=False)
        if system.missing(here, equations) <= NEAR:
            break
    return Reached(here, reached.multipliers)


def _nearest(system: System, equations: CurvatureEquations, start: Point) -> Iterator[Taken]:
    """Take least-norm steps to the equations, straight or in stages; fairness comes after."""
    nothing = np.zeros(len(system.leading))
    for smoother in SMOOTHER:
        other = system.keeping("shape", smoother)
        reached = yield from _closed(other, equations, Reached(start, nothing))
        if system.missing(reached.point, equations) <= NEAR:
            return reached
    here = start
    for taken in in_stages(other, equations.targets, start.vertices):
        here = system.at(taken.vertices, equations)
        yield taken._replace(settled=False)
    return Reached(here, nothing) if system.missing(here, equations) <= NEAR else None
