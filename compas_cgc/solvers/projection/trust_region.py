"""Newton's method on the shapes that fulfil the equations, with the second derivatives of the equations."""

from __future__ import annotations

import math
from collections.abc import Generator
from typing import Optional

import numpy as np

from ...discrete.jacobian import CurvatureEquations
from ...model.tolerances import ROUNDING
from ..constants import MAX_STEPS
from .bordered import Linearised
from .gauss_newton import Taken
from .gauss_newton import Turning
from .iterate import Point
from .quadratic_model import QuadraticModel
from .sequential import NEAR
from .sequential import Reached
from .sequential import corrected
from .system import System

__all__ = ["refine"]

# renewals of the kinds of cells; kinks of mixed areas stop quadratic convergence, and half and twice as many give the same surfaces
CELLS = 3
FIRST = 1e-2  # initial radius over the root of the energy; grows in a few steps where the model holds
LITTLE = 0.1  # actual over predicted decrease below which a step is rejected; Conn, Gould and Toint
WELL = 0.7  # actual over predicted decrease above which the radius grows; Conn, Gould and Toint
SHRINK = 0.25  # factor on the radius after a rejected step; Conn, Gould and Toint
GROW = 2.5  # factor on the radius after a good step; Conn, Gould and Toint
BACK = 3  # moves back onto the equations after a step; a new step costs more, and half and twice as many give the same surfaces
ON = 1e-4  # residual relative to the prescribed curvature on the equations; below what the model of the energy resolves
SETTLED = 1e-7  # longest move relative to the size that ends a search; the square of the next step is at rounding level
POINTLESS = 3e-3  # decrease relative to the energy for which a step is not shortened again; invisible changes of the shape
SMALLEST_STEP = 1e-4  # step over the root of the energy whose decrease is below rounding; the fourth root of the rounding error


def refine(system: System, equations: CurvatureEquations, reached: Reached, enough: float = SETTLED) -> Generator[Taken, None, Reached]:
    """Take steps to the least energy, quadratically convergent and past saddles, until nothing moves any more.

    The longest move that counts as none, against the size of the mesh, is `enough`. Mixed areas have kinks where angles pass 90
    degrees, at which steps do not come to rest. Then cells keep the kinds that they have on a shape, until these are those of the
    shape that is found; the way from there to the equations as they are is short.

    Returns
    -------
    Reached
        Where nothing moves any more, or no step led any further.
    """
    reached, settled = yield from _refined(system, equations, reached, enough)
    own = reached.system or system
    for _ in range(0 if settled else CELLS):
        kept = equations.with_cells_of(reached.point.vertices)
        reached, settled = yield from _refined(own, kept, reached, enough)
        own = reached.system or system
        reached = reached._replace(point=_closed(own, equations, own.at(reached.point.vertices, equations)))
        if np.array_equal(kept.obtuse, equations.with_cells_of(reached.point.vertices).obtuse):
            break
    return reached


def _refined(
    system: System, equations: CurvatureEquations, reached: Reached, enough: float
) -> Generator[Taken, None, tuple[Reached, bool]]:
    """Take steps to the least energy for equations that are smooth functions of the shape; return where, and whether it is at rest.

    Every step is one within the shapes that fulfil the linear equations, and a few moves back onto those that
    fulfil them in truth.

    References
    ----------
    Conn, Gould and Toint, *Trust-Region Methods*, doi:10.1137/1.9780898719857.
    """
    system, multipliers = reached.system or system, reached.multipliers
    here = system.at(reached.point.vertices, equations)
    radius, kept = 0.0, None
    for _ in range(MAX_STEPS):
        system = system.renewed(here, equations, multipliers)
        linear = system.linearised(here, equations, kept)
        model = QuadraticModel(system, equations, linear, here, multipliers)
        if model.energy <= ROUNDING:
            return Reached(here, multipliers, system), True
        kept = linear.kept
        scale = math.sqrt(max(model.energy, 0.0))
        radius = radius or max(model.slope, FIRST * scale)
        trials = 0
        while True:
            trials += 1
            step = model.within(radius)
            there = _returned(system, equations, linear, here, model.normal + step.move)
            ratio = 0.0
            if there is not None and step.promised > 0.0:
                ratio = (model.lagrangian(here) - model.lagrangian(there)) / step.promised
                small = step.length <= SMALLEST_STEP * scale or (
                    step.promised <= POINTLESS * model.energy and _nearer(system, equations, here, there)
                )
                if ratio < LITTLE and not (step.inside and small):
                    there = None
            if there is not None:
                break
            radius = SHRINK * min(radius, step.length)
            if not radius > SETTLED * scale:
                return Reached(here, multipliers, system), False
        if ratio > WELL and not step.inside:
            radius *= GROW
        moved = float(np.abs(there.vertices - here.vertices).max(initial=0.0)) / system.size
        pointless = step.promised <= POINTLESS * model.energy
        here, multipliers = there, step.multipliers
        settled = step.inside and moved * max(step.left, moved) <= enough
        settled = settled and system.renewed(here, equations, multipliers).contact.same(system.contact)
        yield Taken(here.vertices, 1.0, trials, settled)
        if settled:
            return Reached(here, multipliers, system), True
        if trials > 1 and pointless:
            break
    return Reached(here, multipliers, system), False


def _nearer(system: System, equations: CurvatureEquations, here: Point, there: Point) -> bool:
    """Return whether a shape is much nearer to the equations than another: what it gains there hides how its energy changes."""
    return system.missing(there, equations) <= 0.5 * system.missing(here, equations)


def _returned(system: System, equations: CurvatureEquations, linear: Linearised, here: Point, move: np.ndarray) -> Optional[Point]:
    """Return the shape after a move in the free directions (q,) and back onto the equations, None if that is too far."""
    turning = Turning(system, here.vertices)
    there = system.at(system.settled(here.vertices + system.full(linear.landing(move))), equations)
    there = _closed(system, equations, there, linear, turning)
    near = system.missing(there, equations) <= max(NEAR, 0.5 * system.missing(here, equations))
    return there if near and turning.allows(there.vertices) else None


def _closed(
    system: System,
    equations: CurvatureEquations,
    point: Point,
    linear: Optional[Linearised] = None,
    turning: Optional[Turning] = None,
) -> Point:
    """Return the shape after a few moves onto the equations, by their derivatives at a shape nearby or at this one."""
    linear, turning = linear or system.linearised(point, equations), turning or Turning(system, point.vertices)
    for _ in range(BACK):
        if system.missing(point, equations) <= ON or not turning.allows(point.vertices):
            break
        nearer = corrected(system, equations, linear, point, np.zeros(len(point.residual)))
        if not system.missing(nearer, equations) < 0.5 * system.missing(point, equations):
            break
        point = nearer
    return point
