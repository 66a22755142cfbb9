"""Faces divided at new vertices on their sides, the same on both sides of every edge."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask

__all__ = ["SplitSides", "split_sides", "weighted"]


class SplitSides(NamedTuple):
    """Faces, those with new vertices on their sides divided."""

    faces: Faces  # (m', 3) in the order of the old ones
    parent: IntArray  # (m',) old face that each is, or is a part of
    weights: FloatArray  # (m', 3, 3) barycentric weights of the corners in that
    side: IntArray  # (m', 3) side of that on which the side from a corner to the next one lies, -1 inside of it
    ends: Edges  # (k, 2) old vertices between which each new one lies, the lower first; they are numbered after all old ones
    share: FloatArray  # (k,) of the way from the first to the second


# For faces with so many split sides, turned so that these come first: corners of the parts, 0-2 being corners and 3-5
# the new vertices on the sides after them, and where their sides lie on sides of the face (-1: inside).
_PARTS = {
    0: (((0, 1, 2), (0, 1, 2)),),
    1: (((0, 3, 2), (0, -1, 2)), ((3, 1, 2), (0, 1, -1))),
    2: (((3, 1, 4), (0, 1, -1)), ((0, 3, 4), (0, -1, -1)), ((0, 4, 2), (-1, 1, 2))),
    3: (((0, 3, 5), (0, -1, 2)), ((3, 1, 4), (0, 1, -1)), ((4, 2, 5), (1, 2, -1)), ((3, 4, 5), (-1, -1, -1))),
}


def split_sides(faces: Faces, crossing: Mask, start: FloatArray, end: FloatArray, n: int) -> SplitSides:
    """Put a vertex on every edge with a crossing side, and divide all faces beside it.

    Parameters
    ----------
    faces
        ``(m, 3)`` vertex indices.
    crossing
        ``(m, 3)`` the sides that get one, from a corner to the next.
    start, end
        ``(m, 3)`` heights of either end of the sides, of opposite signs where one crosses: the vertex is where the height is zero. Where
        both sides of an edge cross, the first counts.
    n
        Number of vertices.
    """
    ahead = np.roll(faces, -1, axis=1)
    low, high = np.minimum(faces, ahead), np.maximum(faces, ahead)
    key = low * n + high
    chosen, first = np.unique(key[crossing], return_index=True)
    a, b = start[crossing][first], end[crossing][first]
    forward = faces[crossing][first] == low[crossing][first]
    share = np.where(forward, a / np.where(forward, a - b, 1.0), b / np.where(forward, 1.0, b - a))
    at = np.minimum(np.searchsorted(chosen, key), len(chosen) - 1)
    split = chosen[at] == key
    new = np.where(split, n + at, -1)
    # From the lower vertex in both faces, so that an edge gets the same place from both sides.
    onward = faces == low
    part = share[at]
    middles = np.zeros((*faces.shape, 3))
    for c in range(3):
        middles[:, c, c] = np.where(onward[:, c], 1.0 - part[:, c], part[:, c])
        middles[:, c, (c + 1) % 3] = np.where(onward[:, c], part[:, c], 1.0 - part[:, c])
    pieces = [_divided(faces, new, middles, count) for count in range(4)]
    parent, parts, weights, side = (np.concatenate(several) for several in zip(*pieces))
    order = np.argsort(parent, kind="stable")
    ends = np.column_stack([chosen // n, chosen % n])
    return SplitSides(parts[order], parent[order], weights[order], side[order], ends, share)


def weighted(weights: FloatArray, values: FloatArray) -> FloatArray:
    """Return the values at corners (m, 3, ...) with barycentric weights (m, 3, 3) in faces whose corners have values (m, 3, ...).

    Summed in one order, so that two faces give the same value to a vertex on the edge that they share.
    """
    each = weights.reshape(*weights.shape, *[1] * (values.ndim - 2))
    parts = [each[:, :, c] * values[:, None, c] for c in range(3)]
    return parts[0] + parts[1] + parts[2]


def _divided(faces: Faces, new: IntArray, middles: FloatArray, count: int) -> tuple[IntArray, Faces, FloatArray, IntArray]:
    """Return the parts of the faces with `count` split sides: face that they come from, vertices, weights, sides."""
    chosen = np.flatnonzero((new >= 0).sum(axis=1) == count)
    split = new[chosen] >= 0
    # The side that the split ones begin with.
    turn = np.argmax(split & ~np.roll(split, 1, axis=1), axis=1) if count in (1, 2) else np.zeros(len(chosen), np.int64)
    around = (turn[:, None] + np.arange(3)) % 3

    def turned(values: np.ndarray) -> np.ndarray:
        return np.take_along_axis(values, around if values.ndim == 2 else around[..., None], axis=1)

    whole = np.broadcast_to(np.eye(3), (len(chosen), 3, 3))
    nodes = np.hstack([turned(faces[chosen]), turned(new[chosen])])
    weights = np.hstack([turned(whole), turned(middles[chosen])])
    sides = np.hstack([around, np.full((len(chosen), 1), -1)])
    parts = _PARTS[count]
    return (
        np.tile(chosen, len(parts)),
        np.concatenate([nodes[:, list(corners)] for corners, _ in parts]),
        np.concatenate([weights[:, list(corners)] for corners, _ in parts]),
        np.concatenate([sides[:, list(lines)] for _, lines in parts]),
    )
