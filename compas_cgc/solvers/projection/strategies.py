"""The ways that are tried from a start to the targets."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Generator
from collections.abc import Iterator
from itertools import chain
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from ...discrete.space_form import EXACT
from ...model.laws import types_of
from ...model.tolerances import DRAWING_ACCURACY
from ...model.tolerances import NEGLIGIBLE
from ...model.verdict import verdict
from ..constants import WITHIN_REACH
from ..constants import WORTHWHILE
from .exact import exactly
from .exact import may_slide
from .gauss_newton import FINISH
from .gauss_newton import Taken
from .gauss_newton import descend
from .gauss_newton import descend_to_rounding
from .iterate import Point
from .measure import renewed
from .measure import shows_layout
from .measure import smoothed
from .messages import enclosed_negative
from .sequential import NEAR
from .sequential import Reached
from .sequential import approach
from .settings import AUTO
from .settings import ProjectionSettings
from .smooth_shape import DRAWN
from .smooth_shape import LOOSE
from .smooth_shape import smooth_shape
from .starts import is_flat
from .starts import starts
from .system import System
from .trust_region import SETTLED
from .trust_region import refine

__all__ = ["smoothed_first", "ways", "ways_from_near"]

SMOOTHER = (1.0, 0.5, 2.5)  # factors on the smoothness of least-norm steps, one after the other; where one stalls another may converge
# distance of a drawing from the smoothest shape through its rim, relative to the size, above which it is kept; less is invisible
MEANT = 0.01
PATIENT = 4  # steps for each weight of K [steps]; on an irregular mesh with K < 0, half and twice as many lead to another fair surface
HELD = 8  # the same where K < 0 is held all around [steps]; such rims converge slowly, and half and twice as many give the same surfaces

_Smoothing = Callable[[System, CurvatureEquations, Reached], Iterator[Taken]]
_Search = Generator[Taken, None, Optional[Reached]]


def ways(system: System, equations: CurvatureEquations, start: Point, settings: ProjectionSettings, warm: bool) -> Iterator[Taken]:
    """Take steps to the fairest shape near the first start that leads to a fair one, else in other ways from the first.

    A warm start comes before others. The smooth measure is turned to once the surface is fair: only then do fits tell the
    layout of the mesh from wrinkles.
    """
    if not warm and settings.keep == AUTO and _says_which_developable(system, equations, start):
        system = system.keeping("shape")
    tried = starts(system, equations, start)
    if warm:
        again = tried if settings.retry else ()
        tried = chain([system.at(system.settled(start.vertices), equations)], again)
    smooth_first = not warm and settings.retry and settings.measure in (AUTO, "smooth")
    first = next(tried)
    if enclosed_negative(system, equations.targets):
        yield from _held_all_round(system, equations, start, first, settings, smooth_first)
        return
    if smooth_first and _loses_itself(system, equations, first):
        yield from smoothed_first(system, equations, first.vertices, settings)
    if not warm and system.missing(first, equations) <= NEGLIGIBLE:
        # Kept in reserve: where K is asked for twice over the fairest may be out of reach.
        yield Taken(first.vertices, 0.0, 1, settled=False)
    found = None
    if system.keep == "shape" and not warm:
        # The nearest surface is nearly the fairest, and the shortest way to it.
        found = yield from _closing(system, equations, first)
    else:
        found = yield from _fairest(system, equations, chain([first], tried))
    if found is None and settings.retry:
        found = yield from _nearest(system, equations, first)
        system = system.keeping("shape")
    if found is None:
        return
    near = found.point.vertices
    if system.keep == "shape" and settings.measure in EXACT and may_slide(system, equations, settings.measure, near):
        # By angle defects the nearest surface would come to rest in waves, which are then taken out again.
        yield from exactly(system, equations, settings.measure, near)
        return
    reached = yield from refine(system, equations, found, max(SETTLED, settings.tolerance))
    yield from _finished(system, equations, reached, settings, smoothed)


def ways_from_near(system: System, equations: CurvatureEquations, near: Point, settings: ProjectionSettings) -> Iterator[Taken]:
    """Take the nearest way to the equations from a smooth shape, which moves no farther than that takes."""
    reached = Reached(near, np.zeros(len(system.leading)))
    if not system.places.trivial:
        reached = yield from refine(system, equations, (yield from _closed(system, equations, reached)))
    yield from _finished(system, equations, reached, settings, _renewed)


def _finished(
    system: System,
    equations: CurvatureEquations,
    reached: Reached,
    settings: ProjectionSettings,
    smoothing: _Smoothing,
) -> Iterator[Taken]:
    """Take steps from a shape that is fair to the last digits of K in the measure that is asked for."""
    if settings.measure == "smooth":
        yield from smoothing(system, equations, reached)
    elif settings.measure == AUTO:
        if shows_layout(system, equations, reached.point.vertices):
            yield from smoothing(system, equations, reached)
        yield from descend(system, equations, reached.point, patience=FINISH)
    elif settings.measure in EXACT:
        yield from exactly(system, equations, settings.measure, reached.point.vertices)
    else:
        yield from descend_to_rounding(system, equations, reached.point)


def _held_all_round(
    system: System, equations: CurvatureEquations, start: Point, seed: Point, settings: ProjectionSettings, smooth_first: bool
) -> Iterator[Taken]:
    """Take steps where K̄ < 0 and all of the edge is held, which asks for too much: to insist on it would crumple the surface.

    A rim that a smooth surface has leaves room for that, but none for what the layout of a mesh makes of angle defects, be it regular.
    """
    drawn = system.at(system.settled(start.vertices), equations)
    first = seed if is_flat(system, equations, drawn) else drawn
    near, vertices = system.keeping("shape"), first.vertices
    if smooth_first and near.asks_for_k_alone:
        last = None
        for last in smoothed_first(near, equations, vertices, settings, held=True):
            # What does not lead to a fair surface is nothing to show.
            yield Taken(vertices, 0.0, last.trials, settled=False)
        if last is not None and last.equations and verdict(near.problem_at(last.vertices, equations.targets)).fair:
            yield last
    for taken in descend(near, equations, first, WORTHWHILE):
        vertices = taken.vertices
        yield taken
    if settings.measure in EXACT:
        yield from exactly(near, equations, settings.measure, vertices)


def smoothed_first(
    system: System, equations: CurvatureEquations, vertices: FloatArray, settings: ProjectionSettings, held: bool = False
) -> Iterator[Taken]:
    """Take steps from a shape (n, 3), which may be held all round, to one nearby that is smooth, and on to K as asked in that measure."""
    beside, rounds = DRAWN if settings.nearness >= 1.0 else LOOSE, HELD if held else PATIENT
    vertices = yield from smooth_shape(system, equations, vertices, rounds=rounds, beside=beside, smoothed_normals=held)
    yield from renewed(system, equations, vertices)


def _renewed(system: System, equations: CurvatureEquations, reached: Reached) -> Iterator[Taken]:
    """Take steps to the nearest surface in the smooth measure."""
    return renewed(system, equations, reached.point.vertices)


def _loses_itself(system: System, equations: CurvatureEquations, first: Point) -> bool:
    """Return whether steps by angle defects would wrinkle a start, as on irregular meshes where K̄ <= 0."""
    if not system.asks_for_k_alone or not (types_of(equations.targets[system.rows]) <= 0).any():
        return False
    return shows_layout(system, equations, first.vertices)


def _says_which_developable(system: System, equations: CurvatureEquations, drawn: Point) -> bool:
    """Return whether a drawing is all that tells the developable surfaces through a rim apart that is held all round."""
    held = np.isin(system.columns, system.rows).all() and not equations.targets[system.rows].any()
    if not held or not system.asks_for_k_alone:
        return False
    away = drawn.vertices - system.fairness.relaxed()
    return bool(np.abs(away[system.columns]).max(initial=0.0) > MEANT * system.size)


def _fairest(system: System, equations: CurvatureEquations, tried: Iterator[Point]) -> _Search:
    """Return where the first start leads whose end is fair, else where the first leads that arrives."""
    found: Optional[Reached] = None
    begun: list[float] = []
    for point in tried:
        missing = system.missing(point, equations)
        # A mirror twin ends where the other does, and a flat drawing nowhere better.
        if np.isclose(missing, begun, DRAWING_ACCURACY, 0.0).any() or (found is not None and is_flat(system, equations, point)):
            continue
        begun.append(missing)
        other = yield from _approached(system, equations, point)
        if other is not None and verdict(system.problem_at(other.point.vertices, equations.targets)).fair:
            return other
        found = found or other
    return found


def _approached(system: System, equations: CurvatureEquations, point: Point) -> _Search:
    """Approach the equations from a start, and close in on them should that not get near; return where that leads, if it does."""
    reached = yield from approach(system, equations, point)
    if NEAR < system.missing(reached.point, equations) <= WITHIN_REACH:
        reached = yield from _closed(system, equations, reached)
    return reached if system.missing(reached.point, equations) <= NEAR else None


def _closed(system: System, equations: CurvatureEquations, reached: Reached) -> Generator[Taken, None, Reached]:
    """Take least-norm steps until the equations are near enough."""
    here = reached.point
    for taken in descend(system, equations, here):
        here = system.at(taken.vertices, equations)
        yield taken._replace(settled=False)
        if system.missing(here, equations) <= NEAR:
            break
    return Reached(here, reached.multipliers)


def _closing(system: System, equations: CurvatureEquations, start: Point) -> _Search:
    """Take least-norm steps from a start; return what they come to where that is near."""
    reached = yield from _closed(system, equations, Reached(start, np.zeros(len(system.leading))))
    return reached if system.missing(reached.point, equations) <= NEAR else None


def _nearest(system: System, equations: CurvatureEquations, start: Point) -> _Search:
    """Take least-norm steps to the equations, with another smoothness where they stall; fairness comes after."""
    for smoother in SMOOTHER:
        found = yield from _closing(system.keeping("shape", smoother), equations, start)
        if found is not None:
            return found
    return None
