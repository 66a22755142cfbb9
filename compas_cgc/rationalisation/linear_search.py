"""The assignment of panels to moulds and the K of the moulds that bring linearised moves nearest to the design."""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import replace
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from .costs import Allowance
from .normal_moves import LinearMoves
from .normal_moves import NormalMoves
from .normal_moves import Sensitivities

__all__ = ["Assignment", "best_values", "distance_norm", "estimates", "promising_panels", "search"]

POWER = 8  # of the norm, a power of two: near the largest distance, and smooth
CANDIDATES = 40  # single moves of panels that are evaluated, the best by their second-order estimates
GAIN = 1e-4  # part of the norm's power that a move of a panel has to bring
REFIT = 4  # moves of panels after which the K of the moulds follow
PROBES = 15  # random vectors that estimate the curvature of the norm
NEWTON_STEPS, SHORTEST = 6, 1e-3


@dataclass(frozen=True, eq=False)
class Assignment:
    """Which panel has which mould.

    Parameters
    ----------
    values
        ``(k,)`` K of the moulds [1/L^2].
    classes
        ``(p,)`` mould of every panel.
    kept
        ``(k,)`` moulds whose K is given.
    locked
        ``(p,)`` panels whose mould is given.
    """

    values: FloatArray
    classes: IntArray
    kept: Mask
    locked: Mask

    @property
    def K(self) -> FloatArray:
        """K of every panel (p,) [1/L^2]."""
        return self.values[self.classes]


def distance_norm(moves: FloatArray, mass: FloatArray, exponent: int = POWER) -> FloatArray:
    """Return the power mean of distances: of moves (c,) or of several (c, r), weighted by masses (c,) that sum to one [L]."""
    largest = np.maximum(moves.max(axis=0, initial=0.0), -moves.min(axis=0, initial=0.0)) + 1e-300
    power = moves / largest
    for _ in range(exponent.bit_length() - 1):
        power = np.multiply(power, power, out=power)
    return largest * (mass @ power) ** (1.0 / exponent)


def best_values(linear: LinearMoves, mass: FloatArray, assigned: Assignment, steps: int = NEWTON_STEPS) -> Assignment:
    """Return an assignment with the K of its moulds that minimise the distance, by damped Newton steps on the power of the norm."""
    values, count = assigned.values, len(assigned.values)
    member = np.zeros((len(assigned.classes), count))
    member[np.arange(len(member)), assigned.classes] = 1.0
    free = np.flatnonzero(~assigned.kept & (member.sum(axis=0) > 0.0))
    if not len(free):
        return assigned
    columns = linear.by_panel @ member[:, free]
    moves = linear.at(assigned.K)
    norm = float(distance_norm(moves, mass))
    for _ in range(steps):
        weight = mass * (np.abs(moves) / np.abs(moves).max(initial=1e-300)) ** (POWER - 2)
        hessian = (POWER - 1) * (columns * weight[:, None]).T @ columns
        step = -np.linalg.lstsq(hessian, columns.T @ (weight * moves), rcond=1e-12)[0]
        length = 1.0
        while length > SHORTEST:
            there = moves + length * (columns @ step)
            reached = float(distance_norm(there, mass))
            if reached < norm:
                break
            length /= 2
        else:
            break
        values = values.copy()
        values[free] += length * step
        gain, moves, norm = norm - reached, there, reached
        if gain <= 1e-6 * norm:
            break
    return replace(assigned, values=values)


def promising_panels(
    sensitivities: Sensitivities, over: NormalMoves, assigned: Assignment, most: int, allowance: Optional[Allowance] = None
) -> IntArray:
    """Return at most `most` panels whose move to another mould promises the largest decrease of the distance.

    With an allowance that is kept, these are the panels with the least increase of the distance per saving.
    """
    panels = len(assigned.classes)
    if panels <= most:
        return np.arange(panels)
    estimate = estimates(sensitivities, over, assigned)
    if allowance is not None and allowance.keeps(over.criteria(sensitivities.moves)):
        savings = allowance.savings(assigned.values, assigned.classes)
        estimate = np.divide(estimate, savings, out=np.full(estimate.shape, np.inf), where=savings > 0.0)
    return np.sort(np.argsort(estimate.min(axis=1), kind="stable")[:most])


def estimates(sensitivities: Sensitivities, over: NormalMoves, assigned: Assignment) -> FloatArray:
    """Return estimates (p, k) of the change of the norm's power by moving each panel to each mould, 0 for its own and locked ones.

    Slopes come from one adjoint substitution, curvatures of the norm from a few with random signs.

    References
    ----------
    Bekas, Kokiopoulou, Saad, *An estimator for the diagonal of a matrix*, 2007, doi:10.1016/j.apnum.2007.01.003.
    """
    own = over.criteria(sensitivities.moves)
    weight = over.criteria_mass * (np.abs(own) / np.abs(own).max(initial=1e-300)) ** (POWER - 2)
    signs = np.random.default_rng(0).choice([-1.0, 1.0], (len(own), PROBES))
    weights = np.column_stack([weight * own, np.sqrt(weight)[:, None] * signs])
    derivatives = sensitivities.adjoint(over.criteria_transposed(weights))
    slope, second = derivatives[:, 0], (POWER - 1) * (derivatives[:, 1:] ** 2).mean(axis=1)
    changes = assigned.values[None, :] - assigned.K[:, None]
    changes[assigned.locked] = 0.0
    return np.asarray(slope[:, None] * changes + 0.5 * second[:, None] * changes**2)


def search(linear: LinearMoves, mass: FloatArray, assigned: Assignment, most: int, allowance: Optional[Allowance] = None) -> Assignment:
    """Move at most `most` single panels to other moulds as long as the distance decreases; the K of the moulds follow.

    With an allowance, panels move to cheaper moulds as long as it is kept, first those that increase the distance least per saving.
    """
    responses = np.ascontiguousarray(linear.by_panel.T)
    squares = responses**2
    moves = linear.at(assigned.K)
    norm = float(distance_norm(moves, mass))
    for done in range(1, most + 1):
        changes = assigned.values[None, :] - assigned.K[:, None]
        changes[assigned.locked] = 0.0
        saving = allowance if allowance is not None and allowance.keeps(moves) else None
        savings = np.ones(changes.shape) if saving is None else saving.savings(assigned.values, assigned.classes)
        panel, mould = np.nonzero((changes != 0.0) & (savings > 0.0))
        if not len(panel):
            break
        weight = mass * (np.abs(moves) / np.abs(moves).max(initial=1e-300)) ** (POWER - 2)
        slope, second = responses @ (weight * moves), (POWER - 1) * (squares @ weight)
        by = changes[panel, mould]
        estimate = slope[panel] * by + 0.5 * second[panel] * by**2
        saved = savings[panel, mould]
        chosen = np.argsort(estimate / saved, kind="stable")[:CANDIDATES]
        tried = moves + responses[panel[chosen]] * by[chosen, None]
        norms = distance_norm(tried.T, mass)
        rises = (norms**POWER - norm**POWER) / saved[chosen]
        allowed = rises < -GAIN * norm**POWER if saving is None else saving.keeps(tried)
        if not allowed.any():
            break
        best = int(np.argmin(np.where(allowed, rises, np.inf)))
        classes = assigned.classes.copy()
        classes[panel[chosen[best]]] = mould[chosen[best]]
        assigned = replace(assigned, classes=classes)
        moves, norm = tried[best], float(norms[best])
        if done % REFIT == 0:
            assigned = best_values(linear, mass, assigned, 3)
            moves = linear.at(assigned.K)
            norm = float(distance_norm(moves, mass))
    return best_values(linear, mass, assigned)
