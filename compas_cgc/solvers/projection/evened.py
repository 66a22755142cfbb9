"""Evened triangles: vertices moved along a surface to the middle of their neighbours, which slender triangles are rid of so."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from ...discrete import edge_faces
from ...discrete import vertex_normals
from ...discrete.arrays import Faces
from ...discrete.arrays import IntArray
from ...discrete.arrays import Vertices

__all__ = ["evened"]

ROUNDS = 12
PART = 0.5  # of the way to the middle, in a round


def evened(vertices: Vertices, faces: Faces, free: IntArray) -> Vertices:
    """Return vertices (n, 3) of which some (k,) have slid along the surface towards the middle of their neighbours."""
    n = len(vertices)
    u, v = edge_faces(faces)[:, :2].T
    near = sparse.coo_matrix((np.ones(2 * len(u)), (np.r_[u, v], np.r_[v, u])), shape=(n, n)).tocsr()[free]
    count = np.asarray(near.sum(axis=1))
    here = vertices.copy()
    for _ in range(ROUNDS):
        move = PART * ((near @ here) / count - here[free])
        normals = vertex_normals(here, faces)[free]
        here[free] += move - np.einsum("kx,kx->k", move, normals)[:, None] * normals
    return here
