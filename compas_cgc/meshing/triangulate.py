"""Triangulation of polygons without new vertices (ear clipping)."""

from __future__ import annotations

from collections.abc import Mapping
from collections.abc import Sequence
from typing import Optional
from typing import Union

import numpy as np

from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..discrete.arrays import Vertices
from ..errors import names_what_was_meant

__all__ = ["triangles_of", "triangulate"]

Coordinates = Union[Vertices, Mapping[int, Sequence[float]], Sequence[Sequence[float]]]
"""Points by index or key [L]."""
Polygons = Union[Faces, Sequence[Sequence[int]]]
"""Polygons as vertex indices in order."""


@names_what_was_meant()
def triangles_of(vertices: Coordinates, faces: Polygons) -> tuple[Faces, Indices]:
    """Return the triangles of the polygons of a mesh.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates by position or key [L].
    faces
        Polygons of any length, or an array ``(m, 3)``.

    Returns
    -------
    triangles (k, 3), owner (k,)
        Triangles in the order of their polygons, and the polygon of each; polygons with fewer than three different
        corners have none.

    Examples
    --------
    >>> triangles, owner = triangles_of([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    >>> triangles.shape, owner.tolist()
    ((2, 3), [0, 0])
    """
    if isinstance(faces, np.ndarray) or all(len(face) == 3 for face in faces):
        F = np.array(faces, dtype=np.int64).reshape(-1, 3)
        owner = np.flatnonzero((F != np.roll(F, 1, axis=1)).all(axis=1))
        return F[owner], owner
    quads = _plain_quads(vertices, faces)
    others = np.setdiff1d(np.arange(len(faces)), quads)
    parts = [triangulate(vertices, faces[i]) for i in others]
    halves = np.array([faces[i] for i in quads], dtype=np.int64).reshape(-1, 4)[:, [0, 1, 2, 2, 3, 0]].reshape(-1, 3)
    rest = np.array([triangle for part in parts for triangle in part], dtype=np.int64).reshape(-1, 3)
    owner = np.concatenate([np.repeat(quads, 2), np.repeat(others, [len(part) for part in parts])])
    order = np.argsort(owner, kind="stable")
    return np.concatenate([halves, rest])[order], owner[order]


def distinct_corners(face: Sequence[int]) -> list[int]:
    """Return the corners of a face without consecutive repetitions (Rhino's ``a, b, c, c``)."""
    corners = [int(v) for v in face]
    return [v for i, v in enumerate(corners) if v != corners[i - 1] or len(corners) == 1]


@names_what_was_meant()
def triangulate(vertices: Coordinates, face: Sequence[int]) -> list[list[int]]:
    """Return the triangles of a polygon.

    A quad ``a, b, c, d`` is split from a to c, so that a grid of quads has one
    direction of diagonals and valence 6, for which the angle defect is accurate. A quad that
    is concave there is split from b to d. Larger polygons are split by ear clipping.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates by position or key [L].
    face
        Vertex indices in order around the polygon.

    Returns
    -------
    list of [int, int, int]
        Triangles in the same orientation; empty for fewer than three different corners.

    Examples
    --------
    >>> len(triangulate([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [0, 1, 2, 3]))
    2
    """
    corners = distinct_corners(face)
    if len(set(corners)) < 3:
        return []
    if len(corners) == 3:
        return [corners]
    points = np.asarray([vertices[v] for v in corners], dtype=np.float64)
    triangles = []
    normal = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    left = list(range(len(corners)))
    if len(left) == 4:
        # Cut the ear at b first, which leaves the diagonal a-c.
        left = [1, 2, 3, 0]
    # Cutting an ear only affects the corners beside it.
    known: list[Optional[bool]] = [None] * len(left)
    while len(left) > 3:
        ear = 0
        for k, is_ear in enumerate(known):
            known[k] = _is_ear(points, left, k, normal) if is_ear is None else is_ear
            if known[k]:
                ear = k
                break
        triangles.append([corners[left[ear - 1]], corners[left[ear]], corners[left[(ear + 1) % len(left)]]])
        del left[ear], known[ear]
        known[ear - 1] = known[ear % len(left)] = None
    triangles.append([corners[k] for k in left])
    return triangles


def _plain_quads(vertices: Coordinates, faces: Polygons) -> Indices:
    """Return the indices of quads with four different corners that are split by the diagonal from the first to the third."""
    quads = np.array([i for i, face in enumerate(faces) if len(face) == 4 == len(set(face))], dtype=np.int64)
    if not len(quads):
        return quads
    a, b, c, d = np.moveaxis(np.array([[vertices[v] for v in faces[i]] for i in quads], dtype=np.float64), 1, 0)
    normal = np.cross(c - a, d - b)

    def turn(start: FloatArray, end: FloatArray, point: FloatArray) -> FloatArray:
        """Return a value that is positive if a point lies to the left of an edge."""
        return np.einsum("ij,ij->i", np.cross(end - start, point - start), normal)

    holds_d = (turn(a, b, d) >= 0) & (turn(b, c, d) >= 0) & (turn(c, a, d) >= 0)
    return quads[(turn(a, b, c) > 0) & ~holds_d]


def _is_ear(points: FloatArray, left: list[int], k: int, normal: FloatArray) -> bool:
    """Check whether corner `k` is convex and no other corner lies in its triangle."""
    before, here, after = (points[left[i % len(left)]] for i in (k - 1, k, k + 1))
    if np.dot(np.cross(here - before, after - here), normal) <= 0:
        return False
    triangle = np.array([before, here, after])
    others = points[left]
    others = others[~(others[:, None] == triangle).all(axis=2).any(axis=1)]
    edges = np.roll(triangle, -1, axis=0) - triangle
    sides = np.cross(edges[:, None], others - triangle[:, None]) @ normal
    return not (sides.min(axis=0) >= 0).any()
