"""Assignment of panels to moulds by the distance itself: linearise, move few panels, accept on the true distance."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy.sparse.linalg import LinearOperator
from scipy.sparse.linalg import lsqr

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from .clusters import clusterings
from .clusters import nearest_values
from .linear_search import Assignment
from .linear_search import best_values
from .linear_search import distance_norm
from .linear_search import promising_panels
from .linear_search import search
from .normal_moves import NormalMoves
from .normal_moves import Sensitivities

__all__ = ["Moulds", "Placed", "assign", "catalogue", "nearest_surface"]

STEPS, LINEARISATIONS = 3, 8  # of Newton's method after K has changed: steps with the same factors, and how often
CLOSE = 0.05  # deviation of K times the area, below which a surface has its K
RELAXATIONS = 2  # at most, towards the surface of least energy
FINISHING, DONE = 12, 1e-11  # steps to rounding, and the deviation of K times the area that is rounding
ROUNDS = 10  # linearisations from every start
STARTS = 3  # clusterings that are improved
SAME = 0.01  # part of the panels, by which two clusterings differ that lead to the same surface
ACTIVE = 200  # panels that may change their mould in one round
KRYLOV_STEPS = 100  # of LSQR for the nearest surface
TRUST = 0.15  # part of the panels that may change their mould in one round, at first
EVENING, LEAST_GAIN = 10, 0.01  # rounds of weights at most, and the part of the norm below which a round is the last
EVENING_POWERS, LEAST = (4, 8), 1e-3  # of distances as weights, and the weight of no distance against that of the largest
SHORTEST_EVENING = 1.0 / 32.0  # part of a step of a round, below which it ends
SHORTEST = 0.125  # part of the changes of the K of the moulds, below which a search ends
ENOUGH = 0.97  # of the norm of the best surface, below which a round has to promise to come

Watch = Callable[[int, int, float], bool]  # rounds done, rounds at most, largest distance [L]; true cancels


class Placed(NamedTuple):
    """An assignment with its surface."""

    assigned: Assignment
    moves: FloatArray  # (c,) along the normals of the design [L]
    norm: float  # of distances and folds [L]

    @property
    def distance(self) -> float:
        """Largest distance [L]."""
        return float(np.abs(self.moves).max(initial=0.0))


class Moulds(NamedTuple):
    """What is given of the moulds."""

    number: int
    values: Optional[FloatArray] = None  # K of moulds that exist already [1/L^2]
    flat: Optional[bool] = None  # whether one mould is flat
    locked: Optional[IntArray] = None  # (p,) mould of panels that are locked, -1 elsewhere; needs values


def assign(moves: NormalMoves, moulds: Moulds, watch: Optional[Watch] = None) -> Placed:
    """Return the best assignment found of panels to moulds, with its surface.

    From the best of several clusterings, rounds of: linearise the surface in the K of every panel, move a few panels to other moulds
    and fit the K of the moulds on that model, solve the surface, and accept it if its true distance is less; else move fewer panels.
    A start is given up when its model no longer promises to beat the best surface so far; the best one goes on while it gains.
    """
    design = moves.mean_curvatures(np.zeros(len(moves.columns)))
    starts = sorted(_starts(moves, moulds, design), key=lambda placed: placed.norm)
    racers = [_Racer(start, max(1, round(TRUST * moves.panels))) for start in starts]
    best, done, total = starts[0], 0, ROUNDS * len(racers)
    for _ in range(ROUNDS):
        for racer in racers:
            if watch is not None and watch(done, total, best.distance):
                return best
            racer.advance(moves)
            best = racer.here if racer.here.norm < best.norm else best
            done += 1
        racers = [racer for racer in racers if racer.open and (racer.promise < ENOUGH * best.norm or (racer.gains and racer.here is best))]
    if watch is not None:
        watch(total, total, best.distance)
    return best


class _Racer:
    """One of the assignments that are improved at the same time."""

    def __init__(self, start: Placed, trust: int):
        self.here = start
        self.trust = trust  # panels that may change their mould in the next round
        self.length = 1.0  # part of the changes of the K of the moulds that is taken in the next round
        self.promise = start.norm  # by the linear model of the last round [L]
        self.gains = True  # whether the last round was worth it

    @property
    def open(self) -> bool:
        """Whether the next round may change anything."""
        return self.trust > 0 or self.length >= SHORTEST

    def advance(self, moves: NormalMoves) -> None:
        """Move some panels to other moulds if the solved surface is nearer to the design; else allow less next time."""
        there, changed, self.promise = _improved(moves, self.here, self.trust, self.length)
        self.gains = there.norm < ENOUGH * self.here.norm
        if there.norm < self.here.norm:
            self.here, self.length = there, min(1.0, 2.0 * self.length)
        else:
            self.trust, self.length = changed // 3, 0.5 * self.length


def _improved(moves: NormalMoves, here: Placed, trust: int, length: float) -> tuple[Placed, int, float]:
    """Return the surface after at most so many panels have moved to other moulds, how many have, and the norm the model predicts.

    The K of the moulds take a part of their changes in the model, of a given length. Panels that promise little stay, together with all
    others of their mould, so that few columns of sensitivities are needed.
    """
    sensitivities = moves.sensitivities(here.moves, here.assigned.K)
    own = here.assigned
    panels = promising_panels(sensitivities, moves, own, ACTIVE)
    staying = np.ones(moves.panels, bool)
    staying[panels] = False
    moulds, group = np.unique(own.classes[staying], return_inverse=True)
    groups = np.empty(moves.panels, np.int64)
    groups[panels], groups[staying] = np.arange(len(panels)), len(panels) + group
    classes = np.concatenate([own.classes[panels], moulds])
    locked = np.concatenate([own.locked[panels], np.ones(len(moulds), bool)])
    linear = sensitivities.linear(groups)
    found = search(linear.of(moves.criteria), moves.criteria_mass, Assignment(own.values, classes, own.kept, locked), trust)
    found = replace(found, values=own.values + length * (found.values - own.values))
    tried = replace(own, values=found.values, classes=found.classes[groups])
    predicted = linear.at(found.K)
    return _solved(moves, tried, predicted), int((found.classes != classes).sum()), _norm(moves, predicted)


def nearest_surface(moves: NormalMoves) -> FloatArray:
    """Return the K (p,) of the panels of the surface nearest to the design where every panel has its own [1/L^2]."""
    nothing = np.zeros(len(moves.columns))
    return _nearest(moves.sensitivities(nothing, moves.mean_curvatures(nothing)), moves.mass)


def _nearest(sensitivities: Sensitivities, mass: FloatArray) -> FloatArray:
    """Return the K (p,) of least rms distance, to first order, by the method of Paige and Saunders, doi:10.1145/355984.355989."""
    root = np.sqrt(mass)
    own = LinearOperator(
        (len(mass), sensitivities.panels),
        matvec=lambda K: root * sensitivities.forward(np.ravel(K)),
        rmatvec=lambda w: sensitivities.adjoint((root * np.ravel(w))[:, None])[:, 0],
        dtype=np.float64,
    )
    start = sensitivities.K
    away = sensitivities.constant() + sensitivities.forward(start)
    return start + lsqr(own, -root * away, atol=1e-3, btol=1e-3, iter_lim=KRYLOV_STEPS)[0]


def finished(moves: NormalMoves, placed: Placed) -> Placed:
    """Return an assignment with its surface solved to rounding; moulds that are flat within it have K = 0."""
    values = placed.assigned.values
    assigned = replace(placed.assigned, values=np.where(np.abs(values) * moves.size**2 <= DONE, 0.0, values))
    here = placed.moves
    for _ in range(FINISHING):
        if moves.error(here, assigned.K) <= DONE:
            break
        here = moves.newton(here, assigned.K, 1)
    return Placed(assigned, here, _norm(moves, here))


def evened(moves: NormalMoves, placed: Placed) -> Placed:
    """Return an assignment with a surface whose largest distances and folds are less: where they are large, they count more.

    Surface and K of the moulds take damped steps towards those of least weighted squares, with weights that are powers of the criteria.

    References
    ----------
    Burrus, Barreto, Selesnick, *Iterative reweighted least-squares design of FIR filters*, 1994, doi:10.1109/78.330353.
    """
    for power in EVENING_POWERS:
        for _ in range(EVENING):
            before, placed = placed, _evened_once(moves, placed, power)
            if not placed.norm < (1.0 - LEAST_GAIN) * before.norm:
                break
    return placed


def _evened_once(moves: NormalMoves, here: Placed, power: int) -> Placed:
    """Return the surface after one step of :func:`evened` that reduces the norm, or the same one."""
    own = np.abs(moves.criteria(here.moves))
    weights = (own / max(float(own.max(initial=0.0)), 1e-300)) ** power + LEAST
    stressing = moves.stressing(weights / float(moves.criteria_mass @ weights))
    used, groups = np.unique(here.assigned.classes, return_inverse=True)
    linear = stressing.linearised(here.moves, here.assigned.K, groups)
    grouped = Assignment(here.assigned.values[used], np.arange(len(used)), here.assigned.kept[used], np.ones(len(used), bool))
    changes = best_values(linear.of(moves.criteria), moves.criteria_mass, grouped).values - grouped.values
    towards = linear.at(grouped.values + changes) - here.moves
    length = 1.0
    while length >= SHORTEST_EVENING:
        values = here.assigned.values.copy()
        values[used] += length * changes
        tried = _placed(stressing, replace(here.assigned, values=values), here.moves + length * towards)
        if tried.norm < here.norm:
            return tried
        length /= 2.0
    return here


def catalogue(radii: Sequence[float]) -> FloatArray:
    """Return the K of moulds of given radii: spheres of positive radius, saddles of negative ones, flat for an infinite one [1/L^2]."""
    own = np.asarray(radii, dtype=np.float64)
    if own.ndim != 1 or not len(own) or np.isnan(own).any() or (own == 0.0).any():
        raise ValueError(f"moulds must be radii other than 0, such as [8.0, -12.0, inf], not {radii!r}")
    return np.sign(own) / own**2


def _starts(moves: NormalMoves, moulds: Moulds, design: FloatArray) -> list[Placed]:
    """Return the different surfaces of those of several clusterings that the linear model predicts nearest to the design."""
    areas = moves.panel_areas()
    nothing = np.zeros(len(moves.columns))
    sensitivities = moves.sensitivities(nothing, design)
    nearest, constant = _nearest(sensitivities, moves.mass), sensitivities.constant()
    locked = np.zeros(moves.panels, bool) if moulds.locked is None else moulds.locked >= 0
    if moulds.values is not None:
        kept = np.ones(len(moulds.values), bool)
        given = [(moulds.values, kept, nearest_values(sample, moulds.values)) for sample in (design, nearest)]
    elif moulds.number >= moves.panels and not moulds.flat:
        given = [(sample, np.zeros(moves.panels, bool), np.arange(moves.panels)) for sample in (design, nearest)]
    elif moulds.number == 1 and moulds.flat is not False:
        given = [(np.zeros(1), np.ones(1, bool), np.zeros(moves.panels, np.int64))]
    else:
        clusters = clusterings([design, nearest], areas, moulds.number, moulds.flat)
        given = [(values, kept, nearest_values(design, values)) for values, kept in clusters]
    found = []
    for values, kept, own in given:
        classes = own if moulds.locked is None else np.where(locked, moulds.locked, own)
        assigned = Assignment(values, classes, kept, locked)
        predicted = constant + sensitivities.forward(assigned.K)
        found.append(Placed(assigned, predicted, _norm(moves, predicted)))
    promising: list[Placed] = []
    for placed in sorted(found, key=lambda placed: placed.norm)[:STARTS]:
        # Clusterings of many panels often end in the same classes; the K of the moulds are fitted later.
        if all(_moved(placed.assigned, other.assigned) > SAME * moves.panels for other in promising):
            promising.append(placed)
    return [_solved(moves, placed.assigned, placed.moves) for placed in promising]


def _moved(one: Assignment, other: Assignment) -> int:
    """Return the number of panels that have another mould in another assignment, where moulds count by the order of their K."""
    ranks = [np.argsort(np.argsort(own.values, kind="stable"))[own.classes] for own in (one, other)]
    return int((ranks[0] != ranks[1]).sum())


def _solved(moves: NormalMoves, assigned: Assignment, near: FloatArray) -> Placed:
    """Return an assignment with a surface near given moves, relaxed for as long as this brings it nearer to the design."""
    best = _placed(moves, assigned, near)
    for _ in range(RELAXATIONS):
        if not np.isfinite(best.norm):
            break
        relaxed = _placed(moves, assigned, moves.relaxed(best.moves, assigned.K, STEPS))
        if not relaxed.norm < ENOUGH * best.norm:
            break
        best = relaxed
    return best


def _placed(moves: NormalMoves, assigned: Assignment, near: FloatArray) -> Placed:
    """Return an assignment with a surface near given moves, of infinite norm where there is none."""
    here = near
    for _ in range(LINEARISATIONS):
        if moves.error(here, assigned.K) <= CLOSE:
            return Placed(assigned, here, _norm(moves, here))
        here = moves.newton(here, assigned.K, STEPS)
    return Placed(assigned, here, _norm(moves, here) if moves.error(here, assigned.K) <= CLOSE else np.inf)


def _norm(moves: NormalMoves, own: FloatArray) -> float:
    return float(distance_norm(moves.criteria(own), moves.criteria_mass))
