"""Halved edges, and the faces beside them."""

from __future__ import annotations

from typing import Optional

import numpy as np

from ..discrete import edge_faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from .regions import face_regions
from .regions import inner_labels

__all__ = ["halved_faces", "middles", "with_inner_vertices"]

# The children of a face (a, b, c) whose edges ab, bc, ca have the middles 3, 4, 5, for the first one, two or three of these.
CHILDREN = {1: ((0, 3, 2), (3, 1, 2)), 2: ((3, 1, 4), (0, 3, 4), (0, 4, 2)), 3: ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5))}
OTHER = 4  # kind of a face with two halved edges that is divided along the other diagonal
CHILDREN[OTHER] = ((3, 1, 4), (0, 3, 2), (3, 4, 2))
SHORTER = 1.0 - 1e-6  # diagonal over the other one below which it is the shorter one; above, they differ by rounding


def middles(pairs: IntArray, edges: IntArray, count: int) -> IntArray:
    """Return the vertices at the middles of pairs (p, 2): `count` plus the position among the edges (e, 2), -1 for others."""
    codes, wanted = (np.sort(own, axis=1) @ [count, 1] for own in (edges, pairs))
    if not len(codes):
        return np.full(len(wanted), -1)
    order = np.argsort(codes)
    at = order[np.minimum(np.searchsorted(codes, wanted, sorter=order), len(order) - 1)]
    return np.where(codes[at] == wanted, count + at, -1)


def halved_faces(faces: IntArray, edges: IntArray, count: int, vertices: Optional[FloatArray] = None) -> IntArray:
    """Return faces (k, 3) with vertices at the middles of edges (e, 2), numbered from `count` on.

    The faces that there were (m, 3) come first, as their first parts. With vertices (n, d), what is left of a face beside the
    middles of two edges is divided along its shorter diagonal, so that a mirror image is divided alike.
    """
    divided = middles(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), edges, count).reshape(-1, 3)
    number = (divided >= 0).sum(axis=1)
    # Faces are rotated so that their divided edges come first.
    turn = np.where(number == 2, np.argmin(divided, axis=1) + 1, np.where(number == 1, np.argmax(divided, axis=1), 0)) % 3
    by = (np.arange(3) + turn[:, None]) % 3
    corners = np.hstack([np.take_along_axis(faces, by, axis=1), np.take_along_axis(divided, by, axis=1)])
    kind = number.copy()
    if vertices is not None:
        a, b, c = vertices[corners[:, :3].T]
        kind[(number == 2) & (np.linalg.norm(c - (a + b) / 2, axis=1) < SHORTER * np.linalg.norm(a - (b + c) / 2, axis=1))] = OTHER
    first, more = faces.copy(), []
    for own, children in CHILDREN.items():
        of = kind == own
        first[of] = corners[of][:, children[0]]
        more += [corners[of][:, child] for child in children[1:]]
    return np.vstack([first, *more])


def with_inner_vertices(vertices: FloatArray, faces: IntArray, creases: IntArray) -> tuple[FloatArray, IntArray]:
    """Return a mesh whose regions all have vertices of their own: elsewhere the edges across a region are halved.

    A region of one face gets one at its centroid.

    Parameters
    ----------
    vertices
        ``(n, d)`` points [L].
    faces
        ``(m, 3)`` vertex indices.
    creases
        ``(c, 2)`` edges between regions.

    Returns
    -------
    tuple
        Vertices, of which the first are the given ones, and faces.
    """
    regions, edges, n = face_regions(faces, creases), edge_faces(faces), len(vertices)
    left, right = edges[:, 2:].T
    bare = ~np.isin(regions, inner_labels(n, faces, regions))
    halved = edges[(right >= 0) & (regions[left] == regions[right]) & bare[left], :2]
    whole = bare & (np.bincount(regions)[regions] == 1)
    centred = np.flatnonzero(whole)
    vertices = np.vstack([vertices, vertices[halved].mean(axis=1), vertices[faces[centred]].mean(axis=1)])
    a, b, c = faces[centred].T
    middle = n + len(halved) + np.arange(len(centred))
    parts = [np.column_stack(own) for own in ((a, b, middle), (b, c, middle), (c, a, middle))]
    return vertices, np.vstack([halved_faces(faces[~whole], halved, n), *parts])
