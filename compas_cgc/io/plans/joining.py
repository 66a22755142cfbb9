"""Join curves whose ends meet, exactly or across small gaps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy.spatial import cKDTree

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...meshing.chains import chains
from ...meshing.cleanup import Omission
from .plan import PlanCurve
from .plan import length
from .plan import size

__all__ = ["Joined", "joined"]

ROUNDING = 1e-6  # distance within which ends coincide, relative to the size of the drawing
MAX_GAP = 5e-4  # largest gap closed automatically, relative to the size of the drawing
MIN_LENGTH = 10.0  # length of a curve relative to a gap, below which it may be a separate detail


class Joined(NamedTuple):
    """Curves after joining."""

    curves: list[PlanCurve]
    tolerance: float  # [L]
    notes: list[str]


def joined(curves: Sequence[PlanCurve], tolerance: Optional[float] = None) -> Joined:
    """Join open curves end to end where exactly two ends meet, those of one layer first.

    Parameters
    ----------
    curves
        Open and closed curves.
    tolerance
        Distance within which two ends are joined [L]. Default: gaps that are small against the drawing and against both curves.

    Returns
    -------
    Joined
        The joined curves, the tolerance that was used and notes on gaps and duplicates.
    """
    whole = size(curves)
    closed = [curve for curve in curves if curve.is_closed]
    drawn = [curve for curve in curves if not curve.is_closed]
    least = ROUNDING * whole
    open_curves = _without_duplicates(drawn, least)
    notes: list[str] = []
    if len(open_curves) < len(drawn):
        removed = length(drawn) - length(open_curves)
        notes.append(Omission(f"{_plural(len(drawn) - len(open_curves), 'duplicate curve', 'removed')}, {removed:.3g} long together"))
    result: list[PlanCurve] = []
    gaps: list[float] = []
    used = least if tolerance is None else max(tolerance, least)
    for layer in dict.fromkeys(curve.layer for curve in open_curves):
        own = [curve for curve in open_curves if curve.layer == layer]
        chained = _chained(own, least)
        wider = _small_gaps(chained, whole) if tolerance is None else _gaps_within(chained, used)
        if len(wider):
            own_tolerance = 1.001 * float(wider.max())
            chained = _chained(chained, own_tolerance)
            gaps += wider.tolist()
            used = max(used, own_tolerance)
        result += chained
    # An outline may be drawn on several layers.
    still_open = _chained([curve for curve in result if not curve.is_closed], least)
    result = [*(curve for curve in result if curve.is_closed), *still_open]
    if gaps:
        hint = "give 0 as the joining distance to keep them open" if tolerance is None else "as requested"
        notes.append(f"{_plural(len(gaps), 'gap', 'closed')} between ends of curves, up to {max(gaps):.3g} wide; {hint}")
    return Joined([*closed, *result], used, notes)


def _plural(count: int, noun: str, done: str) -> str:
    return f"{count} {noun}{'s' if count > 1 else ''} {'were' if count > 1 else 'was'} {done}"


def _ends(curves: Sequence[PlanCurve]) -> FloatArray:
    """Return the ends (2 m, 3) of curves: first and last point of each in turn."""
    return np.array([curve.points[k] for curve in curves for k in (0, -1)]).reshape(-1, 3)


def _without_duplicates(curves: Sequence[PlanCurve], tolerance: float) -> list[PlanCurve]:
    """Return curves without those that repeat an earlier one of the same layer, in either direction."""
    seen: set[tuple] = set()
    kept = []
    step = max(tolerance, np.finfo(float).tiny)
    for curve in curves:
        rounded = [tuple(np.round(curve.points[k] / step).tolist()) for k in (0, len(curve.points) // 2, -1)]
        key = (curve.layer, len(curve.points), *sorted((rounded[0], rounded[2])), rounded[1] if len(curve.points) > 2 else None)
        if key not in seen:
            kept.append(curve)
        seen.add(key)
    return kept


def _chained(curves: Sequence[PlanCurve], tolerance: float) -> list[PlanCurve]:
    """Return curves joined through every place at which exactly two ends meet."""
    found = chains([curve.points for curve in curves], tolerance)
    return [PlanCurve(chain.points, curves[chain.curves[0]].layer) for chain in found]


def _lone_ends(curves: Sequence[PlanCurve]) -> tuple[FloatArray, FloatArray, IntArray]:
    """Return the distance (2 m,) from each end to the nearest other end, the lengths (m,) of the curves, and that end (2 m,)."""
    ends = _ends(curves)
    distance, nearest = cKDTree(ends).query(ends, k=2)
    lengths = np.array([length([curve]) for curve in curves])
    # The end itself is found first, but not where two ends coincide.
    other = np.where(nearest[:, 0] == np.arange(len(ends)), nearest[:, 1], nearest[:, 0])
    return distance[:, 1], lengths, other


def _small_gaps(curves: Sequence[PlanCurve], whole: float) -> FloatArray:
    """Return the widths of gaps between ends that are each other's nearest and that are small [L]."""
    if not curves:
        return np.empty(0)
    distance, lengths, other = _lone_ends(curves)
    end = np.arange(len(other))
    mutual = (other[other] == end) & (end < other) & (distance > 0)
    length = np.minimum(lengths[end // 2], lengths[other // 2])
    small = (distance <= MAX_GAP * whole) & (MIN_LENGTH * distance < length)
    return distance[mutual & small]


def _gaps_within(curves: Sequence[PlanCurve], tolerance: float) -> FloatArray:
    """Return the widths of gaps between ends that are each other's nearest, up to a tolerance [L]."""
    if not curves:
        return np.empty(0)
    distance, _, other = _lone_ends(curves)
    end = np.arange(len(other))
    return distance[(other[other] == end) & (end < other) & (distance > 0) & (distance <= tolerance)]
