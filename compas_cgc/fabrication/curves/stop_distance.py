"""Stop distance: nearly parallel curves end where they come too near to each other (Jobard and Lefer, 1997)."""

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

SAMPLE_DISTANCE = 0.125  # between the sample points of a curve, relative to the spacing
MIN_START_DISTANCE = 0.7  # least distance of a start point from other curves, relative to the spacing
MIN_STUB = 2.0  # least length of a truncated curve, in spacings
DIRECTION_WEIGHT = 0.6  # distance between directions, per unit distance of their dyads (1.4 at right angles), relative to the spacing


class Neighbours:
    """Sample points and directions of curves; families are not distinguished, because they swap around umbilics.

    Parameters
    ----------
    spacing
        Distance between curves [L].
    stop
        Least distance of nearly parallel curves relative to the spacing; 0 disables it.

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
            self._new = np.vstack([self._new, self._lifted(_sampled(curve.points, SAMPLE_DISTANCE * self._spacing))])
        # The tree is rebuilt when the number of points has doubled, which keeps the amortised cost low.
        if len(self._new) > len(self._old):
            self._old, self._new = np.vstack([self._old, self._new]), self._new[:0]
            self._tree = cKDTree(self._old)

    def clear_part(self, curve: Traced, place: Vectors) -> Traced:
        """Return the part of a new curve around `place` that keeps the stop distance; it may be empty."""
        if self._stop == 0.0 or len(curve.points) < 2:
            return curve
        away = self._away(curve.points)
        nothing = Traced(curve.points[:1], curve.faces[:0])
        if away[np.argmin(np.linalg.norm(curve.points - place, axis=1))] < max(MIN_START_DISTANCE, self._stop) * self._spacing:
            return nothing
        clear = away >= self._stop * self._spacing
        if clear.all():
            return curve
        points, faces = curve
        if is_closed(curve):
            # Start it at a point that is too near.
            first = int(np.argmin(clear))
            points, faces = np.vstack([points[first:-1], points[: first + 1]]), np.roll(faces, -first)
            clear = np.append(np.roll(clear[:-1], -first), False)
        mark = int(np.argmin(np.linalg.norm(points - place, axis=1)))
        blocked = np.flatnonzero(~clear)
        low = int(blocked[blocked < mark].max(initial=-1)) + 1
        high = int(blocked[blocked > mark].min(initial=len(points)))
        part = Traced(points[low:high], faces[low : high - 1])
        return part if arc_lengths_of(part)[-1] > MIN_STUB * self._spacing else nothing

    def _away(self, points: Vectors) -> FloatArray:
        """Return the distances of points (k, 3) from nearly parallel curves (k,) [L], infinite beyond a spacing."""
        lifted, away = self._lifted(points), np.full(len(points), np.inf)
        for tree in (self._tree, cKDTree(self._new) if len(self._new) else None):
            if tree is not None:
                away = np.minimum(away, tree.query(lifted, distance_upper_bound=self._spacing)[0])
        return away

    def _lifted(self, points: Vectors) -> FloatArray:
        """Return points of a polyline with the dyads of its directions (k, 9), which separates crossing curves."""
        along = np.gradient(points, axis=0)
        along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), np.finfo(float).tiny)
        x, y, z = along.T
        twice = np.sqrt(2.0)
        dyads = np.column_stack([x * x, y * y, z * z, twice * x * y, twice * y * z, twice * z * x])
        return np.column_stack([points, DIRECTION_WEIGHT * self._spacing * dyads])


def _sampled(points: Vectors, step: float) -> Vectors:
    """Return points along a polyline (k, 3) at most `step` apart [L]."""
    length = np.linalg.norm(np.diff(points, axis=0), axis=1)
    count = np.maximum(1, np.ceil(length / step)).astype(np.int64)
    share = np.concatenate([np.arange(each) / each for each in count.tolist()])
    start = np.repeat(np.arange(len(count)), count)
    return np.vstack([points[start] + share[:, None] * (points[start + 1] - points[start]), points[-1:]])
