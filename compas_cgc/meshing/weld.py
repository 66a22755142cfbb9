"""Vertex welding, splitting of quads, and removal of degenerate and duplicate faces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray

__all__ = ["Cleaned", "Welded", "clean_faces", "split_quads", "weld"]


@dataclass(frozen=True)
class Welded:
    """A mesh without coincident vertices."""

    vertices: FloatArray  # (k, 3) [L], the first vertex of every merged group, in the old order
    faces: IntArray  # (m, c) indices into `vertices`
    index: IntArray  # (n,) new index of every old vertex, -1 if unused


class Cleaned(NamedTuple):
    """Faces without degenerate and duplicate ones."""

    faces: IntArray  # (k, 3)
    kept: IntArray  # (k,) old indices
    degenerate: int  # number of dropped faces with fewer than three different corners
    duplicate: int  # number of dropped duplicates


def weld(vertices: FloatArray, faces: IntArray, tolerance: float) -> Welded:
    """Merge the vertices that lie within a tolerance of each other and drop unused ones.

    Remaining vertices keep their order and exact coordinates, so a welded mesh does not
    change. Groups are chains: if a is near b and b is near c, all three become a.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, c)`` vertex indices.
    tolerance
        Largest distance of vertices to merge [L]; 0 merges equal ones only.
    """
    V = np.asarray(vertices, dtype=np.float64)
    F = np.asarray(faces, dtype=np.int64)
    n = len(V)
    used = np.zeros(n, bool)
    used[F] = True
    pairs = cKDTree(V).query_pairs(tolerance, output_type="ndarray") if n else np.empty((0, 2), np.int64)
    pairs = pairs[used[pairs].all(axis=1)]
    graph = sparse.coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    _, group = connected_components(graph, directed=False)
    first = np.full(group.max(initial=-1) + 1, n)
    np.minimum.at(first, group, np.arange(n))
    old = np.sort(first[np.unique(group[used])])
    index = np.full(n, -1)
    index[old] = np.arange(len(old))
    index = np.where(used, index[first[group]], -1)
    return Welded(V[old], index[F], index)


def split_quads(vertices: FloatArray, faces: IntArray) -> tuple[IntArray, IntArray]:
    """Return the triangles of quads; a quad with a repeated corner (``a, b, c, c``) is one triangle.

    A quad ``a, b, c, d`` is split from a to c unless it is concave there, as in
    :func:`compas_cgc.meshing.triangulate`.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 4)`` vertex indices.

    Returns
    -------
    triangles (k, 3), owner (k,)
        Triangles in the order of the quads, and the quad of each.
    """
    F = np.asarray(faces, dtype=np.int64).reshape(-1, 4)
    # If a corner repeats the previous one, the others form the triangle.
    repeated = F == np.roll(F, 1, axis=1)
    short = np.flatnonzero(repeated.any(axis=1))
    long = np.flatnonzero(~repeated.any(axis=1))
    result = np.empty((len(F), 2, 3), np.int64)
    keep = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])[np.argmax(repeated[short], axis=1)]
    result[short, 0] = F[short[:, None], keep]
    Q = F[long]
    P = np.asarray(vertices, dtype=np.float64)[Q]
    before, after = np.roll(P, 1, axis=1), np.roll(P, -1, axis=1)
    normal = np.cross(P[:, 2] - P[:, 0], P[:, 3] - P[:, 1])
    convex = np.einsum("mij,mj->mi", np.cross(P - before, after - P), normal) > 0
    along_bd = ~convex[:, [1, 3]].all(axis=1) & convex[:, [0, 2]].all(axis=1)
    result[long, 0] = np.where(along_bd[:, None], Q[:, [1, 2, 3]], Q[:, [0, 1, 2]])
    result[long, 1] = np.where(along_bd[:, None], Q[:, [1, 3, 0]], Q[:, [2, 3, 0]])
    there = np.ones((len(F), 2), bool)
    there[short, 1] = False
    owner = np.repeat(np.arange(len(F)), 2).reshape(-1, 2)
    return result[there], owner[there]


def clean_faces(faces: IntArray) -> Cleaned:
    """Return the triangles without degenerate and duplicate ones."""
    F = np.asarray(faces, dtype=np.int64).reshape(-1, 3)
    whole = (F != np.roll(F, 1, axis=1)).all(axis=1)
    kept = np.flatnonzero(whole)
    key = np.sort(F[kept], axis=1).T
    order = np.lexsort(key)
    again = np.zeros(len(kept), bool)
    again[order[1:]] = (key[:, order[1:]] == key[:, order[:-1]]).all(axis=0)
    distinct = kept[~again]
    return Cleaned(F[distinct], distinct, int(len(F) - len(kept)), int(len(kept) - len(distinct)))
