"""Edges, their faces, and open boundaries."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from numpy.typing import NDArray

from .._compiled import kernel
from ..errors import names_what_was_meant
from ._memo import remembered
from .arrays import Edges
from .arrays import Faces
from .arrays import Indices
from .arrays import Mask
from .arrays import MeshError
from .arrays import PerVertex
from .arrays import Vertices
from .arrays import mesh_arrays

__all__ = ["boundary_vertices", "edge_faces"]


def within_rings(faces: Faces, vertices: Mask, rings: int) -> Mask:
    """Return the vertices (n,) up to a number of edges from some vertices (n,), themselves included."""
    near = vertices.copy()
    for _ in range(rings):
        near[faces[near[faces].any(axis=1)]] = True
    return near


def tops(values: PerVertex, edges: Edges) -> Mask:
    """Return the mask of vertices (n,) whose value (n,) no neighbour along edges (e, 2) exceeds."""
    most = values.copy()
    for one, other in (edges.T, edges[:, ::-1].T):
        np.maximum.at(most, one, values[other])
    return values >= most


def _scrambled(i: Indices) -> NDArray[np.uint64]:
    # The bijective finaliser of splitmix64: distinct vertices have distinct images.
    z = i.astype(np.uint64) + np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


@kernel()
def _add_next_less_previous(F: Faces, image: NDArray[np.uint64], balance: NDArray[np.uint64]) -> None:
    for f in range(F.shape[0]):
        i, j, k = F[f, 0], F[f, 1], F[f, 2]
        balance[i] += image[j] - image[k]
        balance[j] += image[k] - image[i]
        balance[k] += image[i] - image[j]


@remembered
def boundary_mask(n: int, F: Faces) -> Mask:
    """Return a mask of the vertices whose fan of faces is not closed.

    Around a closed fan every neighbour is once the next and once the previous one, so
    the sum over (next - previous) vanishes; around an open fan it is first - last.
    One pass over the faces, without sorting edges.
    """
    balance = np.zeros(n, np.uint64)
    _add_next_less_previous(F, _scrambled(np.arange(n)), balance)
    return balance != 0


@names_what_was_meant()
def boundary_vertices(vertices: ArrayLike, faces: ArrayLike) -> Mask:
    """Return a mask of the vertices on an open boundary.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, consistently oriented.

    Returns
    -------
    (n,) bool

    Examples
    --------
    >>> boundary_vertices(np.eye(3), np.array([[0, 1, 2]])).tolist()
    [True, True, True]
    """
    V, F = mesh_arrays(vertices, faces)
    return boundary_mask(len(V), F)


@names_what_was_meant()
def edge_faces(faces: ArrayLike) -> Edges:
    """Return every edge once with the faces on its two sides.

    Parameters
    ----------
    faces
        ``(m, 3)`` vertex indices of an oriented manifold.

    Returns
    -------
    (e, 4) int64
        ``u, v, left, right`` in order of first appearance: the edge runs from ``u`` to
        ``v`` in the face ``left`` and back in ``right``, which is -1 on a boundary.

    Raises
    ------
    MeshError
        If an edge belongs to more than two faces, or to two of the same orientation.

    Examples
    --------
    >>> edge_faces(np.array([[0, 1, 2], [2, 1, 3]])).tolist()
    [[0, 1, 0, -1], [1, 2, 0, 1], [2, 0, 0, -1], [1, 3, 1, -1], [3, 2, 1, -1]]
    """
    return _edge_faces(np.ascontiguousarray(faces, dtype=np.int64).reshape(-1, 3))


@remembered
def _edge_faces(F: Faces) -> Edges:
    m = len(F)
    u = F.ravel()
    v = np.roll(F, -1, axis=1).ravel()
    owner = np.repeat(np.arange(m), 3)
    low, high = np.minimum(u, v), np.maximum(u, v)
    order = np.lexsort((np.arange(3 * m), high, low))
    low, high = low[order], high[order]
    first = np.ones(3 * m, bool)
    first[1:] = (low[1:] != low[:-1]) | (high[1:] != high[:-1])
    start = np.flatnonzero(first)
    count = np.diff(np.append(start, 3 * m))
    left = order[start]
    edges = np.full((len(start), 4), -1, np.int64)
    edges[:, 0], edges[:, 1], edges[:, 2] = u[left], v[left], owner[left]
    paired = count >= 2
    second = order[start[paired] + 1]
    wrong = count > 2
    wrong[paired] |= u[second] == edges[paired, 0]
    if wrong.any():
        a, b = edges[np.flatnonzero(wrong)[0], :2].tolist()
        raise MeshError(f"edge {a}-{b} does not join exactly two consistently oriented faces; the mesh is not an oriented manifold")
    edges[paired, 3] = owner[second]
    return edges[np.argsort(left, kind="stable")]


def closed_vertices(V: Vertices, F: Faces) -> Mask:
    """Return a mask of the vertices with a closed fan of faces."""
    used = np.zeros(len(V), bool)
    used[F.ravel()] = True
    return used & ~boundary_mask(len(V), F)
