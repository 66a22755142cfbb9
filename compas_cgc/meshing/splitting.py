"""Splitting of vertices at which several parts of a mesh meet."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete.arrays import IntArray

__all__ = ["SplitMesh", "corner_fans", "split_vertices"]


class SplitMesh(NamedTuple):
    """A mesh in which every fan of faces has a vertex of its own."""

    faces: IntArray  # (m, 3); the first fan at a vertex keeps its index, further ones follow after the old vertices
    source: IntArray  # (n,) old index of every vertex


def corner_fans(faces: IntArray) -> IntArray:
    """Return the fan (3 m,) of every corner of the faces (m, 3).

    Two corners at a vertex belong to one fan if their faces are connected across edges at this vertex that belong to two faces.
    """
    m = len(faces)
    corner = np.arange(3 * m)
    after = corner - corner % 3 + (corner + 1) % 3
    u, v = faces.ravel(), faces.ravel()[after]
    code = np.minimum(u, v) * (int(faces.max(initial=0)) + 1) + np.maximum(u, v)
    order = np.argsort(code, kind="stable")
    start = np.flatnonzero(np.diff(code[order], prepend=-1))
    start = start[np.diff(np.append(start, 3 * m)) == 2]
    first, second = order[start], order[start + 1]
    # The corners of the two faces at one end of the edge, then at the other.
    runs_back = u[first] != u[second]
    at_first, at_second = np.where(runs_back, after[second], second), np.where(runs_back, second, after[second])
    i, j = np.concatenate([first, after[first]]), np.concatenate([at_first, at_second])
    return connected_components(sparse.coo_matrix((np.ones(len(i)), (i, j)), shape=(3 * m, 3 * m)), directed=False)[1]


def split_vertices(faces: IntArray, n: int) -> SplitMesh:
    """Give every fan of faces a vertex of its own, so that no edge belongs to more than two faces.

    Parameters
    ----------
    faces
        ``(m, 3)`` vertex indices.
    n
        Number of vertices.
    """
    fan = corner_fans(faces)
    _, first, fan = np.unique(fan, return_index=True, return_inverse=True)
    # Fans in the order of their first corners.
    rank = np.argsort(np.argsort(first))
    owner = faces.ravel()[np.sort(first)]
    _, keeps = np.unique(owner, return_index=True)
    number = np.empty(len(owner), np.int64)
    number[keeps] = owner[keeps]
    added = np.setdiff1d(np.arange(len(owner)), keeps)
    number[added] = n + np.arange(len(added))
    return SplitMesh(number[rank[fan.ravel()]].reshape(-1, 3), np.concatenate([np.arange(n), owner[added]]))
