"""Consistent orientation of faces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask

__all__ = ["Oriented", "orient"]


class Oriented(NamedTuple):
    """Faces with consistent orientation in every connected piece."""

    faces: IntArray  # (m, 3)
    turned: Mask  # (m,) bool: flipped faces
    orientable: bool  # False if a piece is not orientable; such pieces are unchanged


def _joined(faces: IntArray) -> tuple[IntArray, IntArray, Mask]:
    """Return the pairs of faces across manifold edges, and whether both traverse the edge in the same direction."""
    m = len(faces)
    u, v = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    low, high = np.minimum(u, v), np.maximum(u, v)
    order = np.lexsort((high, low))
    fresh = np.ones(3 * m, bool)
    fresh[1:] = (low[order[1:]] != low[order[:-1]]) | (high[order[1:]] != high[order[:-1]])
    start = np.flatnonzero(fresh)
    start = start[np.diff(np.append(start, 3 * m)) == 2]
    first, second = order[start], order[start + 1]
    return first // 3, second // 3, u[first] == u[second]


def orient(faces: IntArray) -> Oriented:
    """Flip as few faces as possible in every piece so that neighbours agree.

    Of two halves of equal size the one with the first face is kept. Edges with more than
    two faces are ignored.

    Parameters
    ----------
    faces
        ``(m, 3)`` vertex indices.
    """
    F = np.asarray(faces, dtype=np.int64).reshape(-1, 3)
    m = len(F)
    a, b, same = _joined(F)
    # Every face has two copies, original and flipped (+ m); an orientable piece gives two components.
    i = np.concatenate([a, a + m])
    j = np.concatenate([np.where(same, b + m, b), np.where(same, b, b + m)])
    graph = sparse.coo_matrix((np.ones(len(i)), (i, j)), shape=(2 * m, 2 * m))
    halves, half = connected_components(graph, directed=False)
    one_sided = half[:m] == half[m:]
    unturned = np.bincount(half[:m], minlength=halves)
    first = np.full(halves, m)
    np.minimum.at(first, half[:m], np.arange(m))
    stay, turn = half[:m], half[m:]
    turned = (unturned[turn] > unturned[stay]) | ((unturned[turn] == unturned[stay]) & (first[turn] < first[stay]))
    turned &= ~one_sided
    result = F.copy()
    result[turned] = F[turned][:, [0, 2, 1]]
    return Oriented(result, turned, not bool(one_sided.any()))
