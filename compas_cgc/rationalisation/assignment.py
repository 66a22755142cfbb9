"""Assignment of panels to moulds by the distance itself: linearise, move few panels, accept on the true distance."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Iterator
from collections.abc import Sequence
from dataclasses import replace
from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy.sparse.linalg import LinearOperator
from scipy.sparse.linalg import lsqr

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from .clusters import clusterings
from .clusters import clusterings_by_signs
from .clusters import nearest_values
from .clusters import signed_root
from .costs import Allowance
from .linear_search import POWER
from .linear_search import Assignment
from .linear_search import best_values
from .linear_search import distance_norm
from .linear_search import estimates
from .linear_search import promising_panels
from .linear_search import search
from .normal_moves import NormalMoves
from .normal_moves import Sensitivities
from .progress import Shown
from .progress import part_of

__all__ = ["Moulds", "Placed", "assign", "catalogue", "cheapened", "finished", "rank"]

STEPS, LINEARISATIONS = 3, 8  # of Newton's method after K has changed: steps with the same factors, and how often
CLOSE = 0.05  # deviation of K times the area, below which a surface has its K; a part of it where the design has less K
FINISHING, DONE = 12, 1e-11  # steps to rounding, and the deviation of K times the area that is rounding
FLAT = 8e-6  # K times the area below which moulds are made flat: their sagitta is below the accuracy of coordinates in files
ROUNDS = 10  # linearisations from every start
STARTS, SOLVED = 4, 3  # clusterings that are improved at most, and how many are solved to choose each
EFFORT = 640  # panels of all starts together: with more panels a start takes longer, and clusterings differ less
SAME = 0.01  # part of the panels, by which two clusterings differ that lead to the same surface
ACTIVE = 200  # panels that may change their mould in one round
KRYLOV_STEPS = 100  # of LSQR for the nearest surface
TRUST = 0.15  # part of the panels that may change their mould in one round, at first
EVENING, LEAST_GAIN = 10, 0.005  # rounds of weights at most, and the part of the norm below which a round is the last
FEW_MOVES = 40  # of one panel or two that are tried in the end, each with its solved surface
FEW_EFFORT = 120  # panels of all these moves together, without costs: with more panels, moves of one or two change less
EVENED_EXCESS = 1.25  # of the allowed distance, above which evening does not bring a surface within it
LAST_POWERS = (16, 32, 64, 128)  # of the norms that are reduced in the end, towards the largest distance
LEAST = 1e-3  # weight of no distance against that of the largest
SHORTEST_EVENING = 1.0 / 32.0  # part of a step of a round, below which it ends
ENOUGH = 0.97  # of the norm of the best surface, below which a round has to promise to come


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


def assign(moves: NormalMoves, moulds: Moulds, watch: Optional[Shown] = None, few_moves: bool = True) -> Placed:
    """Return the best assignment found of panels to moulds, with its surface.

    From the best of several clusterings, rounds of: linearise the surface in the K of every panel, move a few panels to other moulds
    and fit the K of the moulds on that model, solve the surface, even it, and accept it if its true distance is less; else move fewer
    panels. A start is given up when its model no longer promises to beat the best surface so far; the best one goes on while it gains.
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
        racers = [racer for racer in racers if racer.trust and (racer.promise < ENOUGH * best.norm or (racer.gains and racer.here is best))]
    if few_moves:
        best = _by_few_moves(moves, best, lambda own: own.norm, lambda: watch is not None and watch(done, total, best.distance))
    if watch is not None and watch(done, total, best.distance):
        return best
    best = evened(moves, best, LAST_POWERS)
    if watch is not None:
        watch(total, total, best.distance)
    return best


def cheapened(moves: NormalMoves, placed: Placed, allowance: Allowance, watch: Shown) -> Placed:
    """Return an assignment on cheaper and fewer moulds whose solved surface stays within the allowed distance, if the given one does.

    Panels move to cheaper moulds in rounds as in :func:`assign`. Before and after, moulds are closed if that costs less, and their panels
    come off the moulds of nearest K.
    """
    exceeded, _, _ = rank(moves, allowance, placed)
    if exceeded:
        placed = _by_few_moves(moves, placed, lambda own: rank(moves, allowance, own), lambda: watch(0, 3, placed.distance), allowance)
        exceeded, _, _ = rank(moves, allowance, placed)
    if exceeded:
        return placed
    here = _fewer_moulds(moves, placed, allowance, part_of(watch, 0, 3))
    here = _cheaper_panels(moves, here, allowance, part_of(watch, 1, 3))
    return _fewer_moulds(moves, here, allowance, part_of(watch, 2, 3))


def _cheaper_panels(moves: NormalMoves, here: Placed, allowance: Allowance, watch: Shown) -> Placed:
    """Move panels to cheaper moulds in rounds, fewer of them after every round that fails."""
    trust, done = max(1, round(TRUST * moves.panels)), 0
    while trust and not watch(done, done + ROUNDS, here.distance):
        there, changed, _ = _improved(moves, here, trust, allowance)
        here, trust = (there, trust) if rank(moves, allowance, there) < rank(moves, allowance, here) else (here, changed // 3)
        done += 1
    return _by_few_moves(moves, here, lambda own: rank(moves, allowance, own), lambda: watch(done, done + ROUNDS, here.distance), allowance)


def _by_few_moves(
    moves: NormalMoves, here: Placed, key: Callable[[Placed], Any], stopped: Callable[[], bool], allowance: Optional[Allowance] = None
) -> Placed:
    """Move one panel to another mould or exchange the moulds of two, the most promising first, while the solved surface is better by a key.

    The linear model that chooses the panels of a round is coarse, so that its best move may fail where others succeed.
    """
    tried, most = 0, min(FEW_MOVES, (FEW_EFFORT if allowance is None else EFFORT) // moves.panels)
    while tried < most:
        own, stressing = here.assigned, _stressing(moves, here.moves, POWER)
        for classes in _neighbours(moves, here, stressing, allowance):
            if tried == most or stopped():
                return here
            tried += 1
            there = evened(moves, _placed(stressing, replace(own, classes=classes), here.moves))
            if allowance is not None and allowance.excess(moves.criteria(there.moves)) <= EVENED_EXCESS:
                there = evened(moves, there, LAST_POWERS)
            if key(there) < key(here):
                here = there
                break
        else:
            break
    return here


def _neighbours(moves: NormalMoves, here: Placed, stressing: NormalMoves, allowance: Optional[Allowance]) -> Iterator[IntArray]:
    """Yield classes (p,) after moving one panel or exchanging two, in ascending order of their estimates.

    With an allowance that is kept, panels move to cheaper moulds first, in the order of their estimates per saving.
    """
    own = here.assigned
    estimate = estimates(stressing.sensitivities(here.moves, here.assigned.K), moves, own)
    possible = (own.values[None, :] != own.K[:, None]) & ~own.locked[:, None]
    one, other = np.triu_indices(moves.panels, 1)
    exchanged = (own.classes[one] != own.classes[other]) & ~own.locked[one] & ~own.locked[other]
    one, other = one[exchanged], other[exchanged]
    panel, mould = np.nonzero(possible)
    singles, pairs = estimate[panel, mould], estimate[one, own.classes[other]] + estimate[other, own.classes[one]]
    if allowance is not None and allowance.keeps(moves.criteria(here.moves)):
        saved = allowance.savings(own.values, own.classes)[panel, mould]
        panel, mould, singles = panel[saved > 0.0], mould[saved > 0.0], singles[saved > 0.0] / saved[saved > 0.0]
        order = np.concatenate([np.argsort(singles, kind="stable"), len(panel) + np.argsort(pairs, kind="stable")])
    else:
        order = np.argsort(np.concatenate([singles, pairs]), kind="stable")
    for k in order.tolist():
        classes = own.classes.copy()
        if k < len(panel):
            classes[panel[k]] = mould[k]
        else:
            pair = [one[k - len(panel)], other[k - len(panel)]]
            classes[pair] = classes[pair[::-1]]
        yield classes


def _fewer_moulds(moves: NormalMoves, here: Placed, allowance: Allowance, watch: Shown) -> Placed:
    """Close moulds if that costs less, in ascending order of their panels."""
    order = np.argsort(np.bincount(here.assigned.classes, minlength=len(here.assigned.values)), kind="stable").tolist()
    for done, mould in enumerate(order):
        if watch(done, len(order), here.distance):
            break
        here = min(here, _without(moves, here, mould), key=lambda own: rank(moves, allowance, own))
    return here


def rank(moves: NormalMoves, allowance: Optional[Allowance], placed: Placed) -> tuple[bool, float, float]:
    """Return the sort key of an assignment, best first: whether it exceeds the distance, its costs, and its largest distance [L].

    An assignment without a solved surface is the worst.
    """
    largest = float(np.abs(moves.distances(placed.moves)).max(initial=0.0))
    if not np.isfinite(placed.norm):
        return True, np.inf, largest
    if allowance is None or not allowance.keeps(moves.criteria(placed.moves)):
        return True, 0.0, largest
    return False, allowance.total(placed.assigned.values, placed.assigned.classes), largest


def _without(moves: NormalMoves, here: Placed, mould: int) -> Placed:
    """Return an assignment with the panels of a mould, except locked ones, on the mould of nearest K."""
    own = here.assigned
    leave = (own.classes == mould) & ~own.locked
    others = np.setdiff1d(own.classes, [mould])
    if not (leave.any() and len(others)):
        return here
    classes = np.where(leave, others[nearest_values(own.K, own.values[others])], own.classes)
    return evened(moves, _placed(moves, replace(own, classes=classes), here.moves), (POWER, *LAST_POWERS))


class _Racer:
    """One of the assignments that are improved at the same time."""

    def __init__(self, start: Placed, trust: int):
        self.here = start
        self.trust = trust  # panels that may change their mould in the next round
        self.promise = start.norm  # by the linear model of the last round [L]
        self.gains = True  # whether the last round was worth it

    def advance(self, moves: NormalMoves) -> None:
        """Move some panels to other moulds if the solved surface is nearer to the design; else allow less next time."""
        there, changed, self.promise = _improved(moves, self.here, self.trust)
        self.gains = there.norm < ENOUGH * self.here.norm
        if there.norm < self.here.norm:
            self.here = there
        else:
            self.trust = changed // 3


def _improved(moves: NormalMoves, here: Placed, trust: int, allowance: Optional[Allowance] = None) -> tuple[Placed, int, float]:
    """Return the surface after moving at most `trust` panels, the number of moved panels, and the norm that the linear model predicts.

    With an allowance, panels move to cheaper moulds.

    Panels that promise little stay, together with all others of their mould, so that few columns of sensitivities are needed.
    """
    stressing = _stressing(moves, here.moves, POWER)
    sensitivities = stressing.sensitivities(here.moves, here.assigned.K)
    own = here.assigned
    panels = promising_panels(sensitivities, moves, own, ACTIVE, allowance)
    staying = np.ones(moves.panels, bool)
    staying[panels] = False
    moulds, group = np.unique(own.classes[staying], return_inverse=True)
    groups = np.empty(moves.panels, np.int64)
    groups[panels], groups[staying] = np.arange(len(panels)), len(panels) + group
    classes = np.concatenate([own.classes[panels], moulds])
    locked = np.concatenate([own.locked[panels], np.ones(len(moulds), bool)])
    linear = sensitivities.linear(groups).through(here.moves, own.values[classes])
    if allowance is not None:
        allowance = allowance._replace(sizes=np.concatenate([allowance.sizes[panels], np.zeros(len(moulds), np.int64)]))
    found = search(linear.of(moves.criteria), moves.criteria_mass, Assignment(own.values, classes, own.kept, locked), trust, allowance)
    changed = int((found.classes != classes).sum())
    predicted = linear.at(found.K)
    if changed:
        there = replace(own, values=found.values, classes=found.classes[groups])
        here = evened(moves, _placed(stressing, there, predicted), (POWER,) if allowance is None else (POWER, *LAST_POWERS))
    return here, changed, _norm(moves, predicted)


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
    """Return an assignment with its surface solved to rounding; nearly flat moulds get K = 0 unless their K is given."""
    values = placed.assigned.values
    assigned = replace(placed.assigned, values=np.where((np.abs(values) * moves.size**2 <= FLAT) & ~placed.assigned.kept, 0.0, values))
    here = placed.moves
    for _ in range(FINISHING):
        if moves.error(here, assigned.K) <= DONE:
            break
        here = moves.newton(here, assigned.K, 1)
    return _solved(moves, assigned, here)


def evened(moves: NormalMoves, placed: Placed, powers: Sequence[int] = (POWER,)) -> Placed:
    """Return an assignment with a surface nearer to the design in norms of rising powers, that is with less largest distances and folds.

    Surface and K of the moulds take damped steps towards those of least weighted squares, with weights that are powers of the criteria.

    References
    ----------
    Burrus, Barreto, Selesnick, *Iterative reweighted least-squares design of FIR filters*, 1994, doi:10.1109/78.330353.
    """
    for power in powers:
        norm, longest = _norm(moves, placed.moves, power), POWER / power
        for _ in range(EVENING):
            before = norm
            placed, longest = _evened_once(moves, placed, norm, power, longest)
            norm = _norm(moves, placed.moves, power)
            if not norm < (1.0 - LEAST_GAIN) * before:
                break
    return placed


def _evened_once(moves: NormalMoves, here: Placed, norm: float, power: int, longest: float) -> tuple[Placed, float]:
    """Return the surface after one step of :func:`evened` that reduces the norm of a power, or the same one, and twice its length.

    Steps that were too long once mostly are so again: every round starts from twice the length of the last one.
    """
    stressing = _stressing(moves, here.moves, power)
    aim = _fitted(moves, stressing.sensitivities(here.moves, here.assigned.K), here.assigned)
    changes, towards = aim.assigned.values - here.assigned.values, aim.moves - here.moves
    length = min(1.0, longest)
    while length >= SHORTEST_EVENING:
        own = replace(here.assigned, values=here.assigned.values + length * changes)
        tried = _placed(stressing, own, here.moves + length * towards)
        if np.isfinite(tried.norm) and _norm(moves, tried.moves, power) < norm:
            return tried, 2.0 * length
        length /= 2.0
    return here, length


def _stressing(moves: NormalMoves, own: FloatArray, power: int) -> NormalMoves:
    """Return the same surfaces, with squares of criteria weighted as in a norm of a power about given moves (c,)."""
    sizes = np.abs(moves.criteria(own))
    weights = (sizes / max(float(sizes.max(initial=0.0)), 1e-300)) ** (power - 2) + LEAST
    return moves.stressing(weights / float(moves.criteria_mass @ weights))


def _fitted(moves: NormalMoves, sensitivities: Sensitivities, assigned: Assignment) -> Placed:
    """Return an assignment with the K of its moulds that are best on a linear model, and the surface by this model."""
    used, groups = np.unique(assigned.classes, return_inverse=True)
    linear = sensitivities.linear(groups)
    grouped = Assignment(assigned.values[used], np.arange(len(used)), assigned.kept[used], np.ones(len(used), bool))
    values = assigned.values.copy()
    values[used] = best_values(linear.of(moves.criteria), moves.criteria_mass, grouped).values
    predicted = linear.at(values[used])
    return Placed(replace(assigned, values=values), predicted, _norm(moves, predicted))


def catalogue(radii: Sequence[float]) -> FloatArray:
    """Return the K of moulds of given radii: spheres of positive radius, saddles of negative ones, flat for an infinite one [1/L^2]."""
    own = np.asarray(radii, dtype=np.float64)
    if own.ndim != 1 or not len(own) or np.isnan(own).any() or (own == 0.0).any():
        raise ValueError(f"moulds must be radii other than 0, such as [8.0, -12.0, inf], not {radii!r}")
    return np.sign(own) / own**2


def _starts(moves: NormalMoves, moulds: Moulds, design: FloatArray) -> list[Placed]:
    """Return the nearest surfaces, evened, of those of several clusterings that the linear model predicts nearest to the design."""
    sensitivities = moves.sensitivities(np.zeros(len(moves.columns)), design)
    nearest = _nearest(sensitivities, moves.mass * moves.importance[moves.columns] ** 2)
    given = [own for sample in (design, nearest) for own in _given(moves, moulds, sample)]
    starts = max(1, min(STARTS, EFFORT // moves.panels))
    chosen = _most_promising(moves, sensitivities, given, starts)
    # Clusters of K may leave out the panels of one sign, if they are few or nearly flat.
    if moulds.values is None and _has_both_signs(design) and not any(_has_both_signs(own.assigned.K) for own in chosen):
        others = [own for sample in (design, nearest) for own in _by_signs(moves, moulds, sample) if _has_both_signs(own.K)]
        chosen += _most_promising(moves, sensitivities, others, 1)
    return [evened(moves, placed) for placed in chosen]


def _most_promising(moves: NormalMoves, sensitivities: Sensitivities, given: Sequence[Assignment], count: int) -> list[Placed]:
    """Return the nearest of the surfaces, solved, that the linear model predicts nearest to the design."""
    promising: list[Placed] = []
    for placed in sorted((_fitted(moves, sensitivities, own) for own in given), key=lambda placed: placed.norm):
        # Clusterings of many panels often end in the same classes.
        if len(promising) < SOLVED * count and all(_moved(placed.assigned, other.assigned) > SAME * moves.panels for other in promising):
            promising.append(placed)
    solved = [_placed(moves, placed.assigned, placed.moves) for placed in promising]
    return sorted(solved, key=lambda placed: placed.norm)[:count]


def _has_both_signs(K: FloatArray) -> bool:
    return bool((K > 0.0).any() and (K < 0.0).any())


def _given(moves: NormalMoves, moulds: Moulds, sample: FloatArray) -> list[Assignment]:
    """Return the assignments to start from by the K of a sample (p,)."""
    locked = np.zeros(moves.panels, bool) if moulds.locked is None else moulds.locked >= 0
    if moulds.values is not None:
        classes = nearest_values(sample, moulds.values)
        classes = classes if moulds.locked is None else np.where(locked, moulds.locked, classes)
        return [Assignment(moulds.values, classes, np.ones(len(moulds.values), bool), locked)]
    if moulds.number >= moves.panels and not moulds.flat:
        return [Assignment(sample, np.arange(moves.panels), np.zeros(moves.panels, bool), locked)]
    if moulds.number == 1 and moulds.flat is not False:
        return [Assignment(np.zeros(1), np.zeros(moves.panels, np.int64), np.ones(1, bool), locked)]
    return _clustered(moves, moulds, sample, clusterings)


def _by_signs(moves: NormalMoves, moulds: Moulds, sample: FloatArray) -> list[Assignment]:
    """Return the assignments with every number of negative and positive moulds by the K of a sample (p,), none if moulds exist."""
    if moulds.values is not None or moulds.number >= moves.panels or moulds.number == 1:
        return []
    return _clustered(moves, moulds, sample, clusterings_by_signs)


def _clustered(
    moves: NormalMoves,
    moulds: Moulds,
    sample: FloatArray,
    clustered: Callable[[list[FloatArray], FloatArray, int, Optional[bool]], Iterator[tuple[FloatArray, Mask]]],
) -> list[Assignment]:
    """Return assignments by clusters of K (p,) and of its roots."""
    locked, areas = np.zeros(moves.panels, bool), moves.panel_areas()
    found = list(clustered([sample], areas, moulds.number, moulds.flat))
    by_roots = clustered([signed_root(sample)], areas, moulds.number, moulds.flat)
    found += [(values * np.abs(values), kept) for values, kept in by_roots]
    return [Assignment(values, nearest_values(sample, values), kept, locked) for values, kept in found]


def _moved(one: Assignment, other: Assignment) -> int:
    """Return the number of panels that have another mould in another assignment, where moulds count by the order of their K."""
    ranks = [np.argsort(np.argsort(own.values, kind="stable"))[own.classes] for own in (one, other)]
    return int((ranks[0] != ranks[1]).sum())


def _placed(moves: NormalMoves, assigned: Assignment, near: FloatArray) -> Placed:
    """Return an assignment with a surface near given moves, of infinite norm where there is none."""
    here = near
    for _ in range(LINEARISATIONS):
        placed = _solved(moves, assigned, here)
        if np.isfinite(placed.norm):
            return placed
        here = moves.newton(here, assigned.K, STEPS)
    return _solved(moves, assigned, here)


def _solved(moves: NormalMoves, assigned: Assignment, own: FloatArray) -> Placed:
    """Return an assignment with given moves, of infinite norm where they have not come close to its K."""
    close = max(DONE, CLOSE * min(1.0, moves.bend))
    return Placed(assigned, own, _norm(moves, own) if moves.error(own, assigned.K) <= close else np.inf)


def _norm(moves: NormalMoves, own: FloatArray, power: int = POWER) -> float:
    return float(distance_norm(moves.criteria(own), moves.criteria_mass, power))
