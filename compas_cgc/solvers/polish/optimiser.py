"""Sequential quadratic programming with exact second derivatives, convexified as far as the inertia of the saddle matrix calls for."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete.arrays import EPS
from ...discrete.arrays import FloatArray
from ...discrete.arrays import Mask
from ...linalg import SingularMatrixError
from ...model.tolerances import NEGLIGIBLE
from ...model.tolerances import ROUNDING
from ..constants import DECREASE
from ..constants import LOCAL_ROUNDING
from ..constants import LONGEST
from ..constants import MULTIPLIER_MARGIN
from ..constants import SHORTEST
from ..constants import WEIGHT_DECAY
from .lagrangian import Lagrangian
from .lagrangian import State
from .negative_curvature import negative_curvature
from .saddle import Saddle
from .sparsity import Model

__all__ = ["Step", "regularisation", "steps"]

# regularisation of the multipliers relative to the cells and the scale of the law; the root of the rounding error (Vanderbei)
REGULARISATION = 1e-8
CORRECTIONS = 3  # second-order corrections of a trial step; a long step along a valley of the energy leaves the equations (Maratos effect)
EXACT = 1.0  # full share of the non-convex second derivatives; by definition
HALVINGS = 4  # halvings of that share before it is left out; less than a sixteenth has no effect on the step
SHIFT = 1e-4  # first shift of the second derivatives; small, so that nearly convex models hardly change
GROW = 10.0  # factor on the shift; eight factorisations cover all shifts
MOST = 1e4  # largest shift; beyond, the step is that of steepest descent
CLOSE = 1e-2  # step relative to the size from which old factors are tried; second derivatives change by as much
NEARER = 0.1  # fraction of a step that the next one with old factors may leave; slower steps cost more than new factors
MET = 1e-4  # weighted residual over the energy up to which less energy is sought; above, steps towards the equations come first
SETTLED = 1e-8  # move relative to the size that ends a search; the square of the next step is at rounding level


class Step(NamedTuple):
    """One step of the search."""

    state: State
    multipliers: FloatArray  # (r + k,)
    forces: FloatArray  # (c,) of quantities and sides, zero where a side is not touched
    length: float  # part of the full step
    trials: int  # states that were evaluated
    settled: bool  # whether the full step moved nothing any more
    number: int  # from 1


def steps(lagrangian: Lagrangian, start: State, points: FloatArray, size: float) -> Iterator[Step]:
    """Take steps to the least energy that meets the equations, until none leads any further.

    Every step solves

    .. math:: \\begin{pmatrix} W & J^T \\\\ J & -D \\end{pmatrix} \\begin{pmatrix} dx \\\\ \\lambda \\end{pmatrix}
              = \\begin{pmatrix} -\\nabla E \\\\ -r - D \\lambda_0 \\end{pmatrix}

    with the second derivatives W of the Lagrangian, of which the part that is not convex is scaled down until the matrix has as
    many negative eigenvalues as equations: then dx is a minimum. D is small and keeps multipliers that equations do not determine where
    they are; it goes with the root of the residuals, which otherwise would not fall below it where derivatives of the equations almost
    vanish, as on flat spots with K̄ = 0. The merit ``E + σ |r|₁`` decreases in every step, if need be after corrections of second
    order. Goals add conditions ``c + C dx = 0`` and sides ``c + C dx >= 0``, of which those are active that would be crossed, and push
    back.

    Parameters
    ----------
    lagrangian
        The problem.
    start
        Where to begin.
    points
        ``(q + r + k, d)`` places of unknowns and equations, for the order of elimination.
    size
        Size of the mesh [L].

    References
    ----------
    Nocedal and Wright, *Numerical Optimization*, chapter 18, doi:10.1007/978-0-387-40065-5. Waechter and Biegler,
    doi:10.1007/s10107-004-0559-y.
    """
    saddle, here = Saddle(points), lagrangian.untilted(start)
    multipliers, weights, share, shift, number = np.zeros(lagrangian.count), np.zeros(2), EXACT, 0.0, 0
    full, whole = regularisation(lagrangian), lagrangian.scales * lagrangian.cells
    active = ~here.met.one_sided
    while True:
        below = full * math.sqrt(min(1.0, float((np.abs(here.residuals) / whole).max(initial=EPS))))
        model = lagrangian.model(here, multipliers)
        found = _factors(lagrangian, model, saddle, lagrangian.border(here.met, active), below, share, shift)
        if found is None:
            return
        share, shift = found
        right = np.concatenate([-model.gradient, -here.equations - below * multipliers])
        solution, forces, active = _held(lagrangian, saddle, here, right, active)
        step, after = solution[: lagrangian.size], solution[lagrangian.size :]
        if not np.isfinite(solution).all():
            return
        pushes = np.split(after, [len(lagrangian.rows)])
        largest = [float(np.abs(one).max(initial=0.0)) for one in (pushes[0], np.append(pushes[1], forces))]
        weights = np.maximum(WEIGHT_DECAY * weights, MULTIPLIER_MARGIN * np.array(largest))
        slope = float(np.einsum("i,i", model.gradient, step)) - float(weights @ here.missed)
        searched = _search(lagrangian, saddle, here, active, step, slope, weights, size)
        farthest = float(np.abs(step[: lagrangian.moves]).max(initial=0.0))
        if searched is None:
            share, shift = _more_convex(share, shift)
            if shift > MOST:
                return
            continue
        before, multipliers = here, after
        here, length, trials = searched
        if trials == 1 and length == 1.0 and farthest <= CLOSE * size:
            less = None
            if (share < EXACT or shift > 0.0) and float(weights @ before.missed) <= MET * before.energy:
                less = _with_less_energy(lagrangian, saddle, before, model, active, (share, shift), weights, points, size)
            if less is None:
                here, multipliers, forces, farthest = _closed_in(
                    lagrangian, saddle, here, active, multipliers, forces, farthest, ROUNDING * size
                )
            else:
                (here, length, trials), share, shift = less, EXACT, 0.0
        number += 1
        yield Step(here, multipliers, forces, length, trials, length == 1.0 and farthest < SETTLED * size, number)
        if length == 1.0:
            share, shift = min(EXACT, 4.0 * share) if share > 0.0 else EXACT, 0.0 if shift <= SHIFT else shift / GROW


def _held(lagrangian: Lagrangian, saddle: Saddle, here: State, right: FloatArray, active: Mask) -> tuple[FloatArray, FloatArray, Mask]:
    """Return the solution for a right side (q + r + k,) that keeps to the sides, the forces (c,) of the conditions, and which are active.

    Sides that would be crossed become active, those that would have to pull are let go, once each.

    References
    ----------
    Hintermüller, Ito and Kunisch, doi:10.1137/S1052623401383558.
    """
    met, released = here.met, np.zeros(len(active), bool)
    while True:
        solution, pushed = saddle.solve(right, lagrangian.products(met.values, active))
        forces = lagrangian.forces_of(pushed, active)
        left = met.values + met.slopes @ lagrangian.moves_of(solution)
        pulling = met.one_sided & active & (forces > NEGLIGIBLE * float(np.abs(forces).max(initial=0.0)))
        crossed = lagrangian.conditions.worst(np.where(met.one_sided & ~active & ~released, np.minimum(left + LOCAL_ROUNDING, 0.0), 0.0))
        if not pulling.any() and not crossed.any():
            return solution, forces, active
        released, active = released | pulling, active & ~pulling | crossed
        saddle.hold(lagrangian.border(met, active))


def _closed_in(
    lagrangian: Lagrangian, saddle: Saddle, here: State, active: Mask, multipliers: FloatArray, forces: FloatArray, farthest: float,
    enough: float,
) -> tuple[State, FloatArray, FloatArray, float]:  # fmt: skip
    """Return the state, multipliers and forces after steps with factors that are there, while they come nearer fast; and the last move.

    References
    ----------
    Deuflhard, *Newton Methods for Nonlinear Problems*, section 2.1.2, doi:10.1007/978-3-642-23899-4.
    """
    while farthest >= enough and (active | (here.met.missed > -LOCAL_ROUNDING)).all():
        left = np.concatenate([lagrangian.gradient(here, multipliers, forces), here.equations])
        solution, pushed = saddle.roughly(-left, lagrangian.products(here.met.values, active))  # what is missed is part of the next step
        move = float(np.abs(solution[: lagrangian.moves]).max(initial=0.0))
        if not move <= NEARER * farthest:
            break
        here, multipliers = lagrangian.moved(here, solution[: lagrangian.size]), multipliers + solution[lagrangian.size :]
        forces, farthest = forces + lagrangian.forces_of(pushed, active), move
    return here, multipliers, forces, farthest


def regularisation(lagrangian: Lagrangian) -> FloatArray:
    """Return D (r + k,)."""
    return REGULARISATION * np.append(lagrangian.scales * lagrangian.cells, np.ones(len(lagrangian.conditions.vertices)))


def _factors(
    lagrangian: Lagrangian, model: Model, saddle: Saddle, border: FloatArray, below: FloatArray, share: float, shift: float
) -> Optional[tuple[float, float]]:
    """Factorise the saddle matrix, and return the share of the exact second derivatives and the shift that give a minimum."""
    wanted, pattern, stiffness = lagrangian.count, lagrangian.pattern, _stiffness(lagrangian, model)
    while shift <= MOST:
        hessian = model.convex + share * (model.hessian - model.convex)
        try:
            if saddle.factorise(pattern.matrix(model, hessian, shift * stiffness, below), border) == wanted:
                return share, shift
        except SingularMatrixError:
            pass
        share, shift = _more_convex(share, shift)
    return None


def _more_convex(share: float, shift: float) -> tuple[float, float]:
    """Return the next share of the exact second derivatives, or the next shift where none of them are left."""
    if share > 0.0:
        return 0.0 if share <= EXACT / 2**HALVINGS else share / 2, shift
    return share, max(SHIFT, GROW * shift)


def _stiffness(lagrangian: Lagrangian, model: Model) -> float:
    """Return the median stiffness of the unknowns."""
    return float(np.median(model.convex[lagrangian.pattern.diagonal[: lagrangian.size]]))


def _with_less_energy(
    lagrangian: Lagrangian, saddle: Saddle, here: State, model: Model, active: Mask, used: tuple[float, float], weights: FloatArray,
    points: FloatArray, size: float,
) -> Optional[tuple[State, float, int]]:  # fmt: skip
    """Return a state with less energy along a direction of negative curvature, for the share and shift that made the matrix positive."""
    pattern, (share, shift) = lagrangian.pattern, used
    added = (1.0 - share) * (model.convex - model.hessian)
    added[pattern.diagonal[: lagrangian.size]] += shift * _stiffness(lagrangian, model)
    hessian, added = (
        sparse.csr_matrix((own, pattern.indices, pattern.indptr), shape=(pattern.size,) * 2) for own in (model.hessian, added)
    )
    none = lagrangian.products(np.zeros(len(active)), active)

    def responses(load: FloatArray) -> FloatArray:
        solution = saddle.roughly(load, none)[0]
        solution[lagrangian.size :] = 0.0
        return solution

    found = negative_curvature(responses, hessian, added, points[: lagrangian.moves] / size)
    if found is None:
        return None
    longest = CLOSE * size
    step, curvature = longest * found[0][: lagrangian.size], longest**2 * found[1]
    slope = float(np.einsum("i,i", model.gradient, step))
    # On a symmetric surface there is no slope but rounding, and the direction has a side of its own.
    if slope > DECREASE * abs(curvature):
        step, slope = -step, -slope
    slope -= float(weights @ here.missed)
    return _search(lagrangian, saddle, here, active, step, slope, weights, size, curvature)


def _search(
    lagrangian: Lagrangian, saddle: Saddle, here: State, active: Mask, step: FloatArray, slope: float, weights: FloatArray, size: float,
    curvature: float = 0.0,
) -> Optional[tuple[State, float, int]]:  # fmt: skip
    """Return the state after the first of ever shorter steps that decreases the merit, the part of the step, and the trials."""
    farthest = float(np.abs(step[: lagrangian.moves]).max(initial=0.0))
    length = min(1.0, LONGEST * size / farthest) if farthest > 0.0 else 1.0
    before, trials = here.merit(weights), 0
    allowed = ROUNDING * abs(here.energy)
    while length >= SHORTEST:
        move, there = length * step, lagrangian.moved(here, length * step)
        for correction in range(CORRECTIONS + 1):
            trials += 1
            if there.merit(weights) <= before + DECREASE * length * (slope + 0.5 * length * curvature) + allowed:
                return there, length, trials
            if correction < CORRECTIONS:
                # A long step along a valley of the energy leaves the equations, so that without corrections steps would be short.
                right = np.concatenate([np.zeros(lagrangian.size), (1.0 - length) * here.equations - there.equations])
                products = lagrangian.products(there.met.values - (1.0 - length) * here.met.values, active)
                back = saddle.roughly(right, products)[0][: lagrangian.size]
                if not float(np.abs(back[: lagrangian.moves]).max(initial=0.0)) <= LONGEST * size:
                    break  # it leads farther than any step, and may overflow
                move = move + back
                there = lagrangian.moved(here, move)
        length /= 2
    return None
