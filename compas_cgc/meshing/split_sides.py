"""Division of faces at new vertices on their sides, consistent on both sides of every edge."""

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
    """Faces divided at new vertices on their sides."""

    faces: Faces  # (m', 3) in the order of the old ones
    parent: IntArray  # (m',) old face that contains each face
    weights: FloatArray  # (m', 3, 3) barycentric weights of the corners in the old face
    side: IntArray  # (m', 3) side of the old face that contains each side, -1 for inner sides
    ends: Edges  # (k, 2) old vertices on both sides of each new one, the lower first; new vertices come after all old ones
    share: FloatArray  # (k,) position of the new vertex from the first end to the second


# Parts of faces by number of split sides, with these first: corners (0-2 old corners, 3-5 new vertices on the sides
# after them), and the old sides on which their sides lie (-1: inside).
_PARTS = {
    0: (((0, 1, 2), (0, 1, 2)),),
    1: (((0, 3, 2), (0, -1, 2)), ((3, 1, 2), (0, 1, -1))),
    2: (((3, 1, 4), (0, 1, -1)), ((0, 3, 4), (0, -1, -1)), ((0, 4, 2), (-1, 1, 2))),
    3: (((0, 3, 5), (0, -1, 2)), ((3, 1, 4), (0, 1, -1)), ((4, 2, 5), (1, 2, -1)), ((3, 4, 5), (-1, -1, -1))),
}


def split_sides(faces: Faces, crossing: Mask, start: FloatArray, end: FloatArray, n: int) -> SplitSides:
    """Insert a vertex on every edge with a crossing side, and divide its faces.

    Parameters
    ----------
    faces
        ``(m, 3)`` vertex indices.
    crossing
        ``(m, 3)`` mask of the sides that get a vertex, from a corner to the next.
    start, end
        ``(m, 3)`` heights at both ends of the sides, of opposite signs on crossing sides; the new vertex is at height zero. If both
        sides of an edge cross, the first counts.
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
    # Measure from the lower vertex in both faces, so that both sides of an edge agree exactly.
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
    """Return the values at corners (m, 3, ...) interpolated by barycentric weights (m, 3, 3) from values (m, 3, ...).

    The fixed order of summation gives equal values at a vertex on a common edge.
    """
    each = weights.reshape(*weights.shape, *[1] * (values.ndim - 2))
    parts = [each[:, :, c] * values[:, None, c] for c in range(3)]
    return parts[0] + parts[1] + parts[2]


def _divided(faces: Faces, new: IntArray, middles: FloatArray, count: int) -> tuple[IntArray, Faces, FloatArray, IntArray]:
    """Return the parts of faces with `count` split sides: old faces, vertices, weights, sides."""
    chosen = np.flatnonzero((new >= 0).sum(axis=1) == count)
    split = new[chosen] >= 0
    # First of the consecutive split sides.
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
