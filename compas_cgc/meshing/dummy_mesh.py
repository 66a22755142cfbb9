"""Dummy mesh: one ring of faces outside a free edge, so that K can be computed there."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete import edge_faces
from ..discrete import vertex_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.normals import unit_vectors
from ..errors import names_what_was_meant

__all__ = ["dummy_ring"]


@names_what_was_meant()
def dummy_ring(vertices: FloatArray, faces: IntArray, free: Mask) -> tuple[FloatArray, IntArray, IntArray]:
    """Return a mesh with a ring of dummy faces along the boundary loops with a movable vertex.

    Each boundary vertex gets one dummy vertex, one mean boundary edge length outwards. The
    strip has two triangles per boundary edge, so that a boundary vertex of valence 4
    becomes an internal one of valence 6.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    free
        ``(n,)`` bool: movable vertices. Loops without one get no ring.

    Returns
    -------
    vertices (n + d, 3), faces (m + 2 d, 3), inner (d,)
        The dummies come last; ``inner`` is the boundary vertex of each.

    References
    ----------
    Paper, Sections 3.1 and 5.2.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> vertices, faces, added = dummy_ring(square, np.array([[0, 1, 2], [0, 2, 3]]), np.ones(4, bool))
    >>> len(vertices) > 4
    True
    """
    edges = edge_faces(faces)
    rim = edges[edges[:, 3] < 0, :2]
    n = len(vertices)
    graph = sparse.coo_matrix((np.ones(len(rim)), (rim[:, 0], rim[:, 1])), shape=(n, n))
    _, loop = connected_components(graph, directed=False)
    rim = rim[np.isin(loop[rim[:, 0]], loop[rim[free[rim[:, 0]], 0]])]
    u, v = rim[:, 0], rim[:, 1]
    before = np.full(n, -1)
    after = np.full(n, -1)
    after[u], before[v] = v, u
    inner = np.unique(rim)
    to_next, to_last = vertices[after[inner]] - vertices[inner], vertices[inner] - vertices[before[inner]]
    tangent = unit_vectors(unit_vectors(to_next) + unit_vectors(to_last))
    outward = unit_vectors(np.cross(tangent, vertex_normals(vertices, faces)[inner]))
    length = 0.5 * (np.linalg.norm(to_next, axis=1) + np.linalg.norm(to_last, axis=1))
    dummies = vertices[inner] + length[:, None] * outward
    index = np.full(n, -1)
    index[inner] = n + np.arange(len(inner))
    strip = np.concatenate([np.column_stack([v, u, index[u]]), np.column_stack([v, index[u], index[v]])])
    return np.concatenate([vertices, dummies]), np.concatenate([faces, strip]), inner
