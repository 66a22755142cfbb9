"""Sharp edges of meshes, which designs keep as creases."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete import edge_faces
from ..discrete import face_normals
from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..meshing.kinks import KINK_ANGLE
from ..meshing.kinks import angles_between

__all__ = ["sharp_edges"]

RINGS = 2  # of vertices around an edge, whose edges show how much the mesh folds there
SHARE = 0.7  # of these edges fold less; creases that cross are fewer than the rest, a third of the edges of a coarse cylinder fold
ABOVE = 3.0  # of the fold of this share, from which an edge is sharp
CONTINUED = 0.1  # of the least angle of a crease, down to which it goes on
SHORTEST = 0.05  # of the size, below which sharp edges that hang together are flaws of a mesh


def sharp_edges(vertices: FloatArray, faces: IntArray) -> Edges:
    """Return the edges (c, 4) along which a mesh folds much more than around them, and the faces beside them.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    """
    edges = edge_faces(faces)
    inner = edges[edges[:, 3] >= 0]
    normals = face_normals(vertices, faces)
    folds = angles_between(normals[inner[:, 2]], normals[inner[:, 3]])
    folded = np.flatnonzero(folds > CONTINUED * KINK_ANGLE)
    own = np.unique(inner[folded, :2])
    around = np.zeros(len(vertices))
    around[own] = _around(inner[:, :2], folds, len(vertices), own)
    sharp = folded[folds[folded] > ABOVE * around[inner[folded, :2]].max(axis=1)]
    ends = inner[sharp, :2]
    graph = sparse.csr_matrix((np.ones(len(ends)), ends.T), shape=(len(vertices),) * 2)
    part = connected_components(graph, directed=False)[1][ends[:, 0]]
    lengths = np.linalg.norm(vertices[ends[:, 0]] - vertices[ends[:, 1]], axis=1)
    certain = np.bincount(part, lengths * (folds[sharp] > KINK_ANGLE), len(vertices))
    size = float(np.linalg.norm(np.ptp(vertices[np.unique(faces)], axis=0)))
    return inner[sharp[certain[part] > SHORTEST * size]]


def _around(edges: Edges, folds: FloatArray, count: int, vertices: IntArray) -> FloatArray:
    """Return the angle by which most edges around given vertices (k,) fold less [rad]."""
    ends, ones = edges[:, :2], np.ones(len(edges))
    beside = sparse.csr_matrix((ones, ends.T), shape=(count, count))
    near = sparse.identity(count, format="csr")[vertices]
    for _ in range(RINGS):
        near = near @ (beside + beside.T) + near
    touching = sparse.csr_matrix((np.tile(ones, 2), (ends.T.ravel(), np.tile(np.arange(len(edges)), 2))), shape=(count, len(edges)))
    found = (near @ touching).tocsr()
    row = np.repeat(np.arange(len(vertices)), np.diff(found.indptr))
    order = np.lexsort((folds[found.indices], row))
    sizes = np.diff(found.indptr)
    place = found.indptr[:-1] + np.minimum((SHARE * sizes).astype(int), np.maximum(sizes - 1, 0))
    return folds[found.indices][order][place]
