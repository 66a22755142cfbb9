"""Sequential quadratic programming: towards the fairest shape that fulfils the equations."""

from __future__ import annotations

from collections.abc import Generator
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from ..constants import DECREASE
from ..constants import LONGEST
from ..constants import LOOSE_RESIDUAL
from ..constants import MAX_STEPS
from ..constants import MULTIPLIER_MARGIN
from ..constants import SHORTEST
from ..constants import WEIGHT_DECAY
from .bordered import Linearised
from .gauss_newton import Taken
from .gauss_newton import Turning
from .iterate import Point
from .system import System
from .vectors import dot

__all__ = ["NEAR", "Reached", "approach", "corrected"]

SMALL = 0.13  # fraction of a step that counts as short; three halvings, and half and twice it give the same surfaces
# short steps in a row that end the search [steps]; second derivatives are then needed, and half and twice as many give the same surfaces
TIRED = 3
NEAR = 1e-2  # residual relative to the prescribed curvature that is near enough; errors of 1 % are below those of coarse meshes
CALM = 0.02  # squared step over the energy at which second derivatives take over; half of it moves one surface by 3e-4 of the size


class Reached(NamedTuple):
    """Where a search has come to."""

    point: Point
    multipliers: FloatArray  # (l,) of the leading equations
    system: Optional[System] = None  # with the vertices that touch their sides there, where goals say that they shall keep to some


class _Step(NamedTuple):
    move: FloatArray  # (n, 3)
    multipliers: FloatArray  # (l,)
    slope: float  # of the energy along the move
    square: float  # of the move's length in the metric


def approach(system: System, equations: CurvatureEquations, start: Point, most: int = MAX_STEPS) -> Generator[Taken, None, Reached]:
    r"""Take steps towards the least energy, at most so many, for as long as its second derivative is all that is needed.

    Each step solves

    .. math:: \begin{pmatrix} W & J^T \\ J & 0 \end{pmatrix} \begin{pmatrix} dx \\ \lambda \end{pmatrix}
              = \begin{pmatrix} -\nabla E \\ -r \end{pmatrix}

    and is shortened until ``E + σ |r|₁`` decreases, with σ above the largest multiplier. A step that
    fails for the curvature of the equations is mended by a second-order correction first.

    Returns
    -------
    Reached
        Near the least energy, or where no step led any further.

    References
    ----------
    Nocedal and Wright, *Numerical Optimization*, chapter 18, doi:10.1007/978-0-387-40065-5.
    """
    here, multipliers, weight, kept, tired = start, np.zeros(len(system.leading)), 0.0, None, 0
    for done in range(most):
        system = system.renewed(here, equations, multipliers if done else None)
        linear = system.linearised(here, equations, kept)
        kept = linear.kept
        energy, gradient = system.fairness.energy(here.vertices)
        step = _step(system, linear, gradient, multipliers)
        if not np.isfinite(step.move).all():
            break
        multipliers = step.multipliers
        weight = max(WEIGHT_DECAY * weight, MULTIPLIER_MARGIN * float(np.abs(multipliers).max(initial=0.0)))
        found = _search(system, equations, linear, here, step, weight)
        if found is None:
            break
        there, length, trials = found
        here = there
        yield Taken(here.vertices, length, trials, False)
        tired = tired + 1 if length < SMALL else 0
        if tired == TIRED:
            break
        if length == 1.0 and step.square <= CALM * energy and system.missing(here, equations) <= NEAR:
            break
    return Reached(here, multipliers, system)


def _step(system: System, linear: Linearised, gradient: FloatArray, multipliers: FloatArray) -> _Step:
    solver = linear.solver
    # Towards the present multipliers, so that the linear systems need to be no more precise than the step.
    downhill = solver.metric.solve(-(linear.reduced(gradient) + solver.transposed @ multipliers))
    closing = solver.cheapest(linear.right - solver.J @ downhill, LOOSE_RESIDUAL)
    free = downhill + closing.move
    move = linear.landing(free)
    return _Step(system.full(move), multipliers - closing.multipliers, dot(gradient, move), dot(free, solver.metric.times(free)))


def _search(
    system: System, equations: CurvatureEquations, linear: Linearised, here: Point, step: _Step, weight: float
) -> Optional[tuple[Point, float, int]]:
    """Return the first of the halved steps that makes the merit smaller."""
    turning = Turning(system, here.vertices)

    def merit(point: Point) -> float:
        astray = float(np.abs(point.residual).sum() + point.gap.sum() / system.size)
        return system.fairness.energy(point.vertices)[0] + weight * astray

    before = merit(here)
    slope = min(0.0, step.slope - weight * float(np.abs(here.residual).sum()))
    farthest = float(np.sqrt(np.einsum("ij,ij->i", step.move, step.move)).max(initial=0.0))
    length = min(1.0, LONGEST * system.size / farthest) if farthest > 0.0 else 1.0
    trials = 0
    while length > SHORTEST:
        trials += 1
        there = system.at(system.settled(here.vertices + length * step.move), equations)
        for correct in (False, True) if trials <= 2 else (False,):
            if correct:
                there = corrected(system, equations, linear, there, (1.0 - length) * here.residual)
            if turning.allows(there.vertices) and merit(there) <= before + DECREASE * length * slope:
                return there, length, trials
        length /= 2
    return None


def corrected(system: System, equations: CurvatureEquations, linear: Linearised, point: Point, wanted: FloatArray) -> Point:
    """Return a shape near to another with the residuals wanted (k,), by the derivatives of a third."""
    right = (wanted - point.residual)[system.leading]
    move = linear.expanded(linear.solver.cheapest(right, LOOSE_RESIDUAL).move)
    return system.at(system.settled(point.vertices + system.full(move)), equations)
