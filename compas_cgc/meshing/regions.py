"""Regions: connected components of faces separated by creases."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete import edge_faces
from ..discrete._memo import remembered
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..errors import ArgumentError
from ..errors import names_what_was_meant

__all__ = ["face_means", "face_neighbours", "face_regions", "inner_labels", "vertex_labels"]


def face_neighbours(faces: IntArray) -> tuple[IntArray, IntArray]:
    """Return the pairs of faces that share an edge (p, 2), and these edges (p, 2), lower vertex first."""
    F = np.asarray(faces, dtype=np.int64).reshape(-1, 3)
    u, v = F.ravel(), np.roll(F, -1, axis=1).ravel()
    ends = np.column_stack([np.minimum(u, v), np.maximum(u, v)])
    code = ends @ [int(F.max(initial=0)) + 1, 1]
    order = np.argsort(code, kind="stable")
    code = code[order]
    same = code[1:] == code[:-1]
    owner = order // 3
    return np.column_stack([owner[:-1][same], owner[1:][same]]), ends[order[:-1][same]]


@names_what_was_meant()
def face_regions(faces: IntArray, creases: IntArray) -> IntArray:
    """Return the region of every face; regions are separated by creases.

    Parameters
    ----------
    faces
        ``(m, 3)`` vertex indices.
    creases
        ``(c, 2)`` crease edges.

    Returns
    -------
    (m,) int64
        Region of every face, numbered from 0 in the order of first faces.

    Examples
    --------
    >>> face_regions(np.array([[0, 1, 2], [0, 2, 3]]), np.array([[0, 2]])).tolist()
    [0, 1]
    """
    return _face_regions(np.asarray(faces, dtype=np.int64).reshape(-1, 3), np.asarray(creases, dtype=np.int64).reshape(-1, 2))


@remembered
def _face_regions(F: IntArray, creases: IntArray) -> IntArray:
    pairs, ends = face_neighbours(F)
    creases = np.sort(creases, axis=1)
    n = int(max(F.max(initial=0), creases.max(initial=0))) + 1
    open_ = ~np.isin(ends[:, 0] * n + ends[:, 1], creases[:, 0] * n + creases[:, 1])
    pairs = pairs[open_]
    graph = sparse.coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(F), len(F)))
    _, label = connected_components(graph, directed=False)
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    rank = np.empty(len(first), np.int64)
    rank[np.argsort(first, kind="stable")] = np.arange(len(first))
    return rank[inverse.ravel()]


@names_what_was_meant()
def vertex_labels(count: int, faces: IntArray, labels: IntArray) -> IntArray:
    """Return the label of the last face around each of `count` vertices, -1 without faces (n,).

    Parameters
    ----------
    count
        Number of vertices.
    faces
        ``(m, 3)`` vertex indices.
    labels
        ``(m,)`` labels of the faces, such as their regions.

    Returns
    -------
    (n,) int64
        Label of every vertex.

    Examples
    --------
    >>> vertex_labels(4, np.array([[0, 1, 2]]), np.array([7])).tolist()
    [7, 7, 7, -1]
    """
    if faces.max(initial=-1) >= count:
        raise ArgumentError(f"count is {count}, but the faces name vertex {faces.max()}; give the number of all vertices")
    result = np.full(count, -1)
    result[faces.ravel()] = np.repeat(labels, 3)
    return result


def inner_labels(count: int, faces: IntArray, labels: IntArray) -> IntArray:
    """Return the label of each of `count` vertices inside faces of one label, -1 between labels and on the rim (n,)."""
    own, edges = vertex_labels(count, faces, labels), edge_faces(faces)
    left, right = edges[:, 2:].T
    own[edges[(right < 0) | (labels[left] != labels[right]), :2]] = -1
    return own


@names_what_was_meant()
def face_means(faces: IntArray, known: Mask, values: FloatArray) -> FloatArray:
    """Return the mean of the known corner values of every face (m,).

    Faces without known corners take the mean of neighbouring faces, ring by ring.

    Parameters
    ----------
    faces
        ``(m, 3)`` vertex indices.
    known
        ``(n,)`` mask of vertices with known values.
    values
        ``(n,)`` values of the vertices.

    Returns
    -------
    (m,) float64
        Mean value of every face.

    Examples
    --------
    >>> face_means(np.array([[0, 1, 2]]), np.array([True, True, False]), np.array([1.0, 3.0, 9.0])).tolist()
    [2.0]
    """
    incidence = _incidence(faces, len(values))
    count = incidence @ known.astype(np.float64)
    total = incidence @ np.where(known, values, 0.0)
    reached = count > 0
    result = np.divide(total, count, out=np.zeros(len(faces)), where=reached)
    while reached.any() and not reached.all():
        around = incidence @ (incidence.T @ reached.astype(np.float64))
        mean = incidence @ (incidence.T @ np.where(reached, result, 0.0))
        new = ~reached & (around > 0)
        if not new.any():
            break
        result[new] = mean[new] / around[new]
        reached = reached | new
    return result


@remembered
def _incidence(faces: IntArray, n: int) -> sparse.csr_matrix:
    """Return the incidence matrix (m, n) of faces and vertices."""
    corners = np.arange(3 * len(faces)) // 3
    return sparse.csr_matrix((np.ones(len(corners)), (corners, faces.ravel())), shape=(len(faces), n))
