"""Even triangles on a surface: vertices slid to the middle of their neighbours, and edges turned until most have six of them."""

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

DELAUNAY, SIX = 4, 3  # rounds of turning edges for the angles, and then for six neighbours
SLIDES = 3  # for each
PART = 0.5  # of the way to the middle, in a slide
FEWEST = 5  # edges of a vertex: with four, only few places of its neighbours leave its angles the sum that K < 0 asks for
LEAST = np.radians(16.0)  # angle that is left when an edge is turned for six neighbours; sliding makes it larger again


def even_triangles(vertices: Vertices, faces: Faces, free: IntArray, creases: Edges) -> tuple[Vertices, Faces]:
    """Return a mesh of the same surface with the same vertices, some of them slid along it, and edges turned.

    Parameters
    ----------
    vertices
        ``(n, 3)`` [L].
    faces
        ``(m, 3)``.
    free
        ``(k,)`` vertices that slide, none of them on the boundary; edges are turned between triangles that have one.
    creases
        ``(c, 2)`` edges that stay.

    Returns
    -------
    vertices
        ``(n, 3)``, to second order on the surface.
    faces
        ``(m, 3)``, those that were turned in the places of the ones before.
    """
    n, around = len(vertices), np.isin(faces, free).any(axis=1)

    def keeps_angles(triangles: Faces, edges: Diagonals) -> Mask:
        left = np.minimum(*(corner_angles(here, pair).min(axis=1) for pair in edges.turned()))
        return turnable(here, triangles, edges) & (left > LEAST)

    own, here = np.ascontiguousarray(faces[around]), vertices
    kept = np.sort(creases, axis=1) @ np.array([n, 1])
    for k in range(DELAUNAY + SIX):
        if k < DELAUNAY:
            here = _slid(here, own, free)
            own = delaunay_turned(here, own, creases)
        else:
            own = flipped_to_valence(n, own, kept, keeps_angles, FEWEST)
            here = _slid(here, own, free)
    turned = faces.copy()
    turned[around] = own
    return here, turned


def _slid(vertices: Vertices, faces: Faces, free: IntArray) -> Vertices:
    """Return vertices (n, 3) of which some (k,) have slid along the surface towards the middle of their neighbours."""
    n = len(vertices)
    u, v = edge_faces(faces)[:, :2].T
    near = sparse.coo_matrix((np.ones(2 * len(u)), (np.r_[u, v], np.r_[v, u])), shape=(n, n)).tocsr()[free]
    count = np.asarray(near.sum(axis=1))
    here = vertices.copy()
    for _ in range(SLIDES):
        move = PART * ((near @ here) / count - here[free])
        normals = vertex_normals(here, faces)[free]
        here[free] += move - np.einsum("kx,kx->k", move, normals)[:, None] * normals
    return here
