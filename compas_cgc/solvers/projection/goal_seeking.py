"""The way to a surface with goals besides K, and to K where it is not given."""

from __future__ import annotations

from collections.abc import Generator
from collections.abc import Iterator
from itertools import chain
from itertools import islice
from typing import Optional

import numpy as np

from ...discrete.jacobian import CurvatureEquations
from ...discrete.space_form import EXACT
from .exact import exactly
from .found_curvature import FoundCurvature
from .gauss_newton import FINISH
from .gauss_newton import Taken
from .gauss_newton import descend
from .iterate import Point
from .measure import shows_layout
from .measure import smoothed
from .sequential import NEAR
from .sequential import Reached
from .sequential import approach
from .settings import AUTO
from .settings import ProjectionSettings
from .starts import starts
from .system import System
from .trust_region import refine

__all__ = ["goal_ways"]

TRIED = 3  # starts; bounds the time, the first ones are the likeliest
ROUNDS = 4  # rounds of finishing [rounds]; each may bring vertices across sides, ever fewer


def goal_ways(system: System, equations: CurvatureEquations, start: Point, settings: ProjectionSettings, warm: bool) -> Iterator[Taken]:
    """Take steps from the starts for the curvature alone to the fairest shape that meets the goals too.

    All are unknowns and equations of one solve: the goals of the whole surface border the linear systems, K that is not given
    is eliminated from them, and vertices that touch a side change with the steps.
    """
    guess = equations.guessed() if isinstance(equations, FoundCurvature) else equations
    alone = system.without_goals()
    drawing = alone.at(start.vertices, guess)
    tried: Iterator[Point] = islice(starts(alone, guess, drawing), TRIED)
    if warm:
        tried = chain([drawing], tried if settings.retry else ())
    for first in tried:
        reached = yield from _sought(system, equations, first)
        if reached is not None:
            reached = yield from refine(system, equations, reached)
            if settings.measure == "smooth":
                yield from smoothed(reached.system or system, equations, reached)
            elif settings.measure in EXACT:
                yield from exactly(reached.system or system, equations, settings.measure, reached.point.vertices)
            else:
                shape = reached.point.vertices
                plain = equations.given(shape) if isinstance(equations, FoundCurvature) else equations
                if settings.measure == AUTO and shows_layout(system, plain, shape):
                    yield from smoothed(reached.system or system, equations, reached)
                yield from _finished(equations, reached)
            return


def _sought(system: System, equations: CurvatureEquations, first: Point) -> Generator[Taken, None, Optional[Reached]]:
    """Return a shape near to the equations and the goals, None where there is no way to one."""
    here = system.at(system.settled(first.vertices), equations)
    reached = yield from approach(system, equations, here)
    own = reached.system or system
    here = reached.point
    if own.missing(here, equations) > NEAR:
        for taken in descend(own, equations, here):
            here = own.at(taken.vertices, equations)
            yield taken._replace(settled=False)
            if own.missing(here, equations) <= NEAR:
                break
    return Reached(here, reached.multipliers, own) if own.missing(here, equations) <= NEAR else None


def _finished(equations: CurvatureEquations, reached: Reached) -> Iterator[Taken]:
    """Take least-norm steps to rounding; vertices that come to cross a side in them touch it."""
    system, here = reached.system, reached.point
    assert system is not None
    for _ in range(ROUNDS):
        here = system.at(system.settled(here.vertices), equations)
        for taken in descend(system, equations, here, patience=FINISH):
            here = system.at(taken.vertices, equations)
            yield taken
        system = system.renewed(here, equations, None)
        if not (np.abs(here.gap) > 0.0).any():
            return
