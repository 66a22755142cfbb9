"""Even triangles on a surface: vertices slide to the centre of their neighbours, and flips bring valences to six."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from ..discrete import edge_faces
from ..discrete import vertex_normals
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.arrays import Vertices
from ..discrete.corners import corner_angles
from .delaunay_flips import delaunay_turned
from .delaunay_flips import turnable
from .edge_flips import Diagonals
from .edge_flips import flipped_to_valence

__all__ = ["even_triangles"]

DELAUNAY_ROUNDS, VALENCE_ROUNDS = 4, 3  # rounds of Delaunay flips, then of valence flips
SLIDES = 3  # slides per round
SLIDE_FRACTION = 0.5  # fraction of the way to the centre per slide
MIN_VALENCE = 5  # with four edges the angle sum of K < 0 is hard to reach
MIN_ANGLE = np.radians(16.0)  # least angle after a valence flip; sliding enlarges it again


def even_triangles(vertices: Vertices, faces: Faces, free: IntArray, creases: Edges) -> tuple[Vertices, Faces]:
    """Return a mesh of the same surface with some vertices slid along it and edges flipped.

    Parameters
    ----------
    vertices
        ``(n, 3)`` [L].
    faces
        ``(m, 3)``.
    free
        ``(k,)`` vertices that slide, none of them on the boundary; edges are flipped between triangles that have one.
    creases
        ``(c, 2)`` edges that are not flipped.

    Returns
    -------
    vertices
        ``(n, 3)``, on the surface to second order.
    faces
        ``(m, 3)``; flipped faces keep the indices of the old ones.
    """
    n, around = len(vertices), np.isin(faces, free).any(axis=1)

    def keeps_angles(triangles: Faces, edges: Diagonals) -> Mask:
        left = np.minimum(*(corner_angles(here, pair).min(axis=1) for pair in edges.turned()))
        return turnable(here, triangles, edges) & (left > MIN_ANGLE)

    own, here = np.ascontiguousarray(faces[around]), vertices
    kept = np.sort(creases, axis=1) @ np.array([n, 1])
    for k in range(DELAUNAY_ROUNDS + VALENCE_ROUNDS):
        if k < DELAUNAY_ROUNDS:
            here = _slid(here, own, free)
            own = delaunay_turned(here, own, creases)
        else:
            own = flipped_to_valence(n, own, kept, keeps_angles, MIN_VALENCE)
            here = _slid(here, own, free)
    turned = faces.copy()
    turned[around] = own
    return here, turned


def _slid(vertices: Vertices, faces: Faces, free: IntArray) -> Vertices:
    """Return vertices (n, 3) with some (k,) slid along the surface towards the centre of their neighbours."""
    n = len(vertices)
    u, v = edge_faces(faces)[:, :2].T
    near = sparse.coo_matrix((np.ones(2 * len(u)), (np.r_[u, v], np.r_[v, u])), shape=(n, n)).tocsr()[free]
    count = np.asarray(near.sum(axis=1))
    here = vertices.copy()
    for _ in range(SLIDES):
        move = SLIDE_FRACTION * ((near @ here) / count - here[free])
        normals = vertex_normals(here, faces)[free]
        here[free] += move - np.einsum("kx,kx->k", move, normals)[:, None] * normals
    return here
