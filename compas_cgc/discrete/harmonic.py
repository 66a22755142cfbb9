"""Values spread smoothly over a mesh from where they are known."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from .arrays import TINY
from .arrays import Faces
from .arrays import FloatArray
from .arrays import Mask
from .arrays import Vertices
from .topology import edge_faces

__all__ = ["spread_values"]


def spread_values(vertices: Vertices, faces: Faces, values: FloatArray, known: Mask) -> FloatArray:
    """Return values of which those not known are the means of their neighbours', weighted by nearness.

    Parameters
    ----------
    vertices, faces
        ``(n, 3)`` [L], ``(m, 3)``.
    values
        ``(n,)`` or ``(n, k)``.
    known
        ``(n,)`` where they stay, at one vertex of every part of the mesh or more.
    """
    result = values.copy()
    if known.all():
        return result
    u, v = edge_faces(faces)[:, :2].T
    weight = 1.0 / np.maximum(np.linalg.norm(vertices[u] - vertices[v], axis=1), TINY)
    n = len(vertices)
    graph = sparse.csr_matrix((np.r_[weight, weight], (np.r_[u, v], np.r_[v, u])), shape=(n, n))
    rows = (sparse.diags(np.asarray(graph.sum(axis=1)).ravel()) - graph).tocsr()[~known]
    result[~known] = splu(rows[:, ~known].tocsc()).solve(-(rows[:, known] @ values[known]))
    return result
