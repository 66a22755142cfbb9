"""Development onto the plane: a rigid frame carried from face to face."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np
from numba import njit
from numpy.typing import ArrayLike
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order
from scipy.sparse.csgraph import connected_components

from ..discrete import edge_faces
from ..discrete import mesh_arrays
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.arrays import Vertices

__all__ = ["PlaneLayout", "cut_open", "unfold"]

ComplexArray = NDArray[np.complex128]


class PlaneLayout(NamedTuple):
    """A mesh in the plane, opened along its seams."""

    plane: FloatArray  # (k, 2) places of its vertices, of which a seam has two [L]
    faces: Faces  # (m, 3) into these
    origin: IntArray  # (k,) vertex in space of each
    gap: float  # largest distance between the places that faces give to one vertex [L]
    edge_error: float  # largest relative difference between an edge in the plane and in space


def unfold(vertices: ArrayLike, faces: ArrayLike, seams: Optional[ArrayLike] = None) -> PlaneLayout:
    """Lay a mesh out in the plane, face after face.

    Every face keeps its shape, and a rigid motion carries it to the edge that it shares with the one before it, breadth
    first from the middle. Lengths are not taken off circles, so that errors do not grow from ring to ring. Where the
    mesh is flat (no angle defect) and its seams open it to a disk the faces close up, and `gap` is at rounding.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices of an oriented manifold.
    seams
        ``(s, 2)`` edges that are cut. Default: none.

    Returns
    -------
    PlaneLayout
        Each connected part about an origin of its own, normals up.

    Raises
    ------
    MeshError
        If the arrays are no oriented manifold.

    Examples
    --------
    >>> roof = np.array([[0, 0, 0], [3, 0, 0], [3, 1, 1], [0, 1, 1.0]])
    >>> type(unfold(roof, np.array([[0, 1, 2], [0, 2, 3]]))).__name__
    'PlaneLayout'
    """
    V, F = mesh_arrays(vertices, faces)
    edges = edge_faces(F)
    joined = edges[(edges[:, 3] >= 0) & ~among(edges[:, :2], seams, len(V))]
    corners = _placed(V, F, joined)
    opened, origin = cut_open(F, joined)
    count = np.bincount(opened.ravel(), minlength=len(origin))
    plane = np.column_stack([np.bincount(opened.ravel(), corners[..., axis].ravel(), len(origin)) for axis in (0, 1)]) / count[:, None]
    gap = 2.0 * float(np.linalg.norm(corners - plane[opened], axis=2).max(initial=0.0))
    return PlaneLayout(plane, opened, origin, gap, edge_error(V, F, plane[opened]))


def among(edges: Edges, chosen: Optional[ArrayLike], n: int) -> Mask:
    """Tell which edges (e, 2) are among others (s, 2) of a mesh of n vertices, whatever their direction (e,)."""
    own = np.sort(edges, axis=1) @ np.array([n, 1])
    others = np.sort(np.asarray(() if chosen is None else chosen, dtype=np.int64).reshape(-1, 2), axis=1) @ np.array([n, 1])
    return np.isin(own, others)


def cut_open(faces: Faces, joined: Edges) -> tuple[Faces, IntArray]:
    """Return faces (m, 3) that share vertices across joined edges (e, 4) only, and the old vertex of each new one (k,)."""
    m = len(faces)
    u, v, left, right = joined.T
    pairs = np.vstack([np.column_stack([_corner(faces, left, w), _corner(faces, right, w)]) for w in (u, v)])
    graph = sparse.coo_matrix((np.ones(len(pairs), np.int8), (pairs[:, 0], pairs[:, 1])), shape=(3 * m, 3 * m))
    _, label = connected_components(graph, directed=False)
    # In the order of the old vertices, so that a mesh without seams keeps its numbers.
    _, first = np.unique(label, return_index=True)
    order = np.argsort(faces.ravel()[first], kind="stable")
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    return rank[label].reshape(m, 3), faces.ravel()[first][order]


def edge_error(vertices: Vertices, faces: Faces, corners: FloatArray) -> float:
    """Return the largest relative difference between the edges of faces in the plane, as corners (m, 3, 2), and in space."""
    ahead = np.roll(corners, -1, axis=1) - corners
    places = vertices[faces]
    length = np.linalg.norm(np.roll(places, -1, axis=1) - places, axis=2)
    return float(np.abs(np.linalg.norm(ahead, axis=2) / length - 1.0).max(initial=0.0))


def flat_triangles(vertices: Vertices, faces: Faces) -> ComplexArray:
    """Return every face by itself in the plane, its first corner at 0 and its first edge along x: complex (m, 3) [L]."""
    a, b, c = vertices[faces].transpose(1, 0, 2)
    ab, ac = b - a, c - a
    length = np.linalg.norm(ab, axis=1)
    x = np.einsum("ij,ij->i", ab, ac) / length
    y = np.linalg.norm(np.cross(ab, ac), axis=1) / length
    return np.column_stack([0.0 * length, length, x + 1j * y])


def _placed(V: Vertices, F: Faces, joined: Edges) -> FloatArray:
    """Return the place that each face gives to its corners (m, 3, 2)."""
    m = len(F)
    own = flat_triangles(V, F)
    u, v, left, right = joined.T
    number = np.arange(1, len(joined) + 1)
    graph = sparse.coo_matrix((np.r_[number, number], (np.r_[left, right], np.r_[right, left])), shape=(m, m)).tocsr()
    count, part = connected_components(graph, directed=False)
    centres = V[F].mean(axis=1)
    order, before = [], np.full(m, -1)
    for label in range(count):
        inside = np.flatnonzero(part == label) if count > 1 else np.arange(m)
        middle = inside[np.argmin(np.linalg.norm(centres[inside] - centres[inside].mean(axis=0), axis=1))]
        reached, parents = breadth_first_order(graph, middle, directed=False)
        order.append(reached)
        before[reached[1:]] = parents[reached[1:]]
    # The edge that each face hangs on.
    hanging = np.flatnonzero(before >= 0)
    edge = np.zeros(m, np.int64)
    edge[hanging] = np.asarray(graph[hanging, before[hanging]]).ravel().astype(np.int64) - 1
    start, end = u[edge], v[edge]
    corner = np.zeros((m, 4), np.int64)
    for column, (face, vertex) in enumerate(((before, start), (before, end), (np.arange(m), start), (np.arange(m), end))):
        corner[hanging, column] = _corner(F, face[hanging], vertex[hanging]) % 3
    turn, shift = _carried(own, np.concatenate(order).astype(np.int64), before, corner)
    placed = own * turn[:, None] + shift[:, None]
    return np.stack([placed.real, placed.imag], axis=2)


def _corner(F: Faces, faces: IntArray, vertices: IntArray) -> IntArray:
    """Return the corners, numbered through all faces, at which faces have vertices."""
    return 3 * faces + np.argmax(F[faces] == vertices[:, None], axis=1)


@njit(cache=True)
def _carried(own: ComplexArray, order: IntArray, before: IntArray, corner: IntArray) -> tuple[ComplexArray, ComplexArray]:
    """Return the rigid motions z -> turn z + shift that lay the faces out, each from that of the face before it."""
    turn, shift = np.ones(len(before), np.complex128), np.zeros(len(before), np.complex128)
    for f in order:
        g = before[f]
        if g < 0:
            continue
        p, q = own[g, corner[f, 0]], own[g, corner[f, 1]]
        r, s = own[f, corner[f, 2]], own[f, corner[f, 3]]
        rotation = turn[g] * (q - p) * np.conj(s - r)
        turn[f] = rotation / abs(rotation)
        shift[f] = turn[g] * 0.5 * (p + q) + shift[g] - turn[f] * 0.5 * (r + s)
    return turn, shift
