"""Stop distance: curves that run the same way end where they come too near to each other (Jobard and Lefer, 1997)."""

from __future__ import annotations

from typing import Optional

import numpy as np
from scipy.spatial import cKDTree

from ...discrete.arrays import FloatArray
from ...discrete.arrays import Vectors
from .crossings import arc_lengths_of
from .crossings import is_closed
from .trace import Traced

__all__ = ["Neighbours"]

SAMPLED = 0.125  # of the spacing, between the places of a curve that others keep away from
BEGIN = 0.7  # of the spacing, that a curve has to begin apart from others, more than it may come near to them
STUB = 2.0  # spacings, below which a curve that ends at others is left out
ACROSS = 0.6  # of the spacing: two directions count as so far from each other for every unit between their dyads, 1.4 at right angles


class Neighbours:
    """Where curves are and which way they run: around a point of no direction families change places, so they are not told apart.

    Parameters
    ----------
    spacing
        Between curves [L].
    stop
        Part of it that curves which run the same way keep apart; 0 lets them go on.

    References
    ----------
    Jobard and Lefer, Creating evenly-spaced streamlines of arbitrary density, doi:10.1007/978-3-7091-6876-9_5.
    """

    def __init__(self, spacing: float, stop: float):
        self._spacing, self._stop = spacing, stop
        self._old, self._new = np.zeros((0, 9)), np.zeros((0, 9))
        self._tree: Optional[cKDTree] = None

    def add(self, curve: Traced) -> None:
        """Add a curve."""
        if self._stop > 0.0:
            self._new = np.vstack([self._new, self._lifted(_sampled(curve.points, SAMPLED * self._spacing))])
        # A tree of all is built anew when as many have been added, so that no curve costs much.
        if len(self._new) > len(self._old):
            self._old, self._new = np.vstack([self._old, self._new]), self._new[:0]
            self._tree = cKDTree(self._old)

    def clear_part(self, curve: Traced, place: Vectors) -> Traced:
        """Return the part of a new curve around a place on it that keeps its distance, or nothing of it."""
        if self._stop == 0.0 or len(curve.points) < 2:
            return curve
        away = self._away(curve.points)
        nothing = Traced(curve.points[:1], curve.faces[:0])
        if away[np.argmin(np.linalg.norm(curve.points - place, axis=1))] < max(BEGIN, self._stop) * self._spacing:
            return nothing
        clear = away >= self._stop * self._spacing
        if clear.all():
            return curve
        points, faces = curve
        if is_closed(curve):
            # Let it begin where it is too near.
            first = int(np.argmin(clear))
            points, faces = np.vstack([points[first:-1], points[: first + 1]]), np.roll(faces, -first)
            clear = np.append(np.roll(clear[:-1], -first), False)
        mark = int(np.argmin(np.linalg.norm(points - place, axis=1)))
        blocked = np.flatnonzero(~clear)
        low = int(blocked[blocked < mark].max(initial=-1)) + 1
        high = int(blocked[blocked > mark].min(initial=len(points)))
        part = Traced(points[low:high], faces[low : high - 1])
        return part if arc_lengths_of(part)[-1] > STUB * self._spacing else nothing

    def _away(self, points: Vectors) -> FloatArray:
        """Return how far the points of a curve (k, 3) are from others that run the same way (k,) [L], infinite from a spacing on."""
        lifted, away = self._lifted(points), np.full(len(points), np.inf)
        for tree in (self._tree, cKDTree(self._new) if len(self._new) else None):
            if tree is not None:
                away = np.minimum(away, tree.query(lifted, distance_upper_bound=self._spacing)[0])
        return away

    def _lifted(self, points: Vectors) -> FloatArray:
        """Return the points of a polyline with the dyads of its directions (k, 9), in which curves that cross are far from each other."""
        along = np.gradient(points, axis=0)
        along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), np.finfo(float).tiny)
        x, y, z = along.T
        twice = np.sqrt(2.0)
        dyads = np.column_stack([x * x, y * y, z * z, twice * x * y, twice * y * z, twice * z * x])
        return np.column_stack([points, ACROSS * self._spacing * dyads])


def _sampled(points: Vectors, step: float) -> Vectors:
    """Return points along a polyline (k, 3) that are no farther from each other than a step [L]."""
    length = np.linalg.norm(np.diff(points, axis=0), axis=1)
    count = np.maximum(1, np.ceil(length / step)).astype(np.int64)
    share = np.concatenate([np.arange(each) / each for each in count.tolist()])
    start = np.repeat(np.arange(len(count)), count)
    return np.vstack([points[start] + share[:, None] * (points[start + 1] - points[start]), points[-1:]])
