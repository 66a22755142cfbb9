"""Choice of the number of moulds and, with costs, of their kinds."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Mapping
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np

from ..errors import CGCError
from ..model.counts import counted
from .assignment import Moulds
from .assignment import Placed
from .assignment import assign
from .assignment import catalogue
from .assignment import cheapened
from .assignment import finished
from .assignment import rank
from .costs import Allowance
from .normal_moves import NormalMoves
from .progress import Shown
from .progress import part_of

__all__ = ["MAX_MOULDS", "MouldsInput", "Wanted", "best_moulds"]

MAX_MOULDS = 16  # largest number of moulds that is tried to keep a distance

MouldsInput = Union[int, Sequence[float], None]


class Wanted(NamedTuple):
    """Moulds and distance that a user prescribes."""

    moulds: MouldsInput
    flat: Optional[bool] = None  # whether one mould is flat
    locked: Optional[Mapping[int, int]] = None  # prescribed moulds of panels
    allowance: Optional[Allowance] = None  # allowed distance, and costs


def best_moulds(moves: NormalMoves, wanted: Wanted, shown: Shown) -> Placed:
    """Return the nearest assignment or, with an allowance, the cheapest within it, without costs the one with the fewest moulds."""
    allowance, best = wanted.allowance, None
    tried = list(_tried(moves, wanted))
    for past, own in enumerate(tried):
        if best is not None and not _may_be_better(moves, allowance, best, own):
            continue
        watch = part_of(shown, past, len(tried))
        if best is not None and watch(0, 1, best.distance):
            break
        found = finished(moves, _found(moves, own, allowance, watch))
        best = found if best is None or rank(moves, allowance, found) < rank(moves, allowance, best) else best
    assert best is not None
    return best


def _found(moves: NormalMoves, own: Moulds, allowance: Optional[Allowance], watch: Shown) -> Placed:
    """Return the nearest assignment to some moulds or, with costs, a cheaper one within the allowed distance."""
    if allowance is None or allowance.costs is None:
        return assign(moves, own, watch)
    return cheapened(moves, assign(moves, own, part_of(watch, 0, 2), few_moves=False), allowance, part_of(watch, 1, 2))


def _tried(moves: NormalMoves, wanted: Wanted) -> Iterator[Moulds]:
    """Yield the moulds to try: existing ones, or ascending numbers of moulds with and without a flat one."""
    moulds, allowance = wanted.moulds, wanted.allowance
    if moulds is not None and not isinstance(moulds, (int, np.integer)):
        yield _existing(moves, moulds, wanted.locked)
        return
    if wanted.locked:
        raise CGCError("locked panels need existing moulds; give the radii of the moulds as moulds=[...]")
    if moulds is None and allowance is None:
        raise CGCError("moulds=None needs within=, the largest distance from the design [L]; the fewest moulds that satisfy it are used")
    if isinstance(moulds, bool) or (moulds is not None and moulds < 1):
        raise CGCError(f"moulds must be a number from 1 up, or radii, not {moulds!r}")
    most = min(MAX_MOULDS if moulds is None else int(moulds), moves.panels)
    cheapest = allowance is not None and allowance.costs is not None
    for count in range(1 if moulds is None or cheapest else most, most + 1):
        for flat in (True, False) if cheapest and wanted.flat is None else (wanted.flat,):
            yield Moulds(count, flat=flat)


def _existing(moves: NormalMoves, radii: Sequence[float], locked: Optional[Mapping[int, int]]) -> Moulds:
    """Return moulds of given radii and the locked panels."""
    values = catalogue(radii)
    if not locked:
        return Moulds(len(values), values)
    own = np.full(moves.panels, -1)
    for number, mould in locked.items():
        if not (0 <= number < moves.panels and 0 <= mould < len(values)):
            raise CGCError(
                f"panel {number} cannot be locked to mould {mould}: "
                f"there are {counted(moves.panels, 'panel')} and {counted(len(values), 'mould')}, counted from 0"
            )
        own[number] = mould
    return Moulds(len(values), values, locked=own)


def _may_be_better(moves: NormalMoves, allowance: Optional[Allowance], best: Placed, own: Moulds) -> bool:
    """Check whether other moulds may be better: nearer if the best ones exceed the distance, otherwise cheaper."""
    exceeded, cost, _ = rank(moves, allowance, best)
    return exceeded or (allowance is not None and allowance.least(own.number, own.flat) < cost)
