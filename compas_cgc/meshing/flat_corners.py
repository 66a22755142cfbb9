"""Corners of supported boundaries, and the flat faces in them, in which the other diagonal is used for curvature."""

from __future__ import annotations

import numpy as np

from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.corners import corner_angles
from .edge_flips import diagonals

__all__ = ["flat_corners", "turned_corners"]

MAX_CORNER = np.radians(150.0)  # larger corners lose almost nothing to a flat face
MAX_SIDE_ANGLE = np.radians(75.0)  # larger angles may make the flip impossible


def flat_corners(faces: IntArray, held: Mask) -> IntArray:
    """Return the flat corner triangles (k,): all three vertices are fixed, and one has no other face.

    Parameters
    ----------
    faces
        ``(m, 3)``.
    held
        ``(n,)`` mask of fixed vertices.
    """
    still = np.flatnonzero(held[faces].all(axis=1))
    alone = np.bincount(faces.ravel(), minlength=len(held)) == 1
    return still[alone[faces[still]].any(axis=1)]


def turned_corners(vertices: FloatArray, faces: IntArray, held: Mask, creases: Edges) -> IntArray:
    """Return triangles (m, 3) with the edges of flat corner triangles flipped, so that they run into the corner.

    A flat face cuts off its corner whatever the surface. The flips depend on fixed vertices only, so they are the same for all
    surfaces of a drawing.

    Parameters
    ----------
    vertices
        ``(n, 3)`` [L].
    faces
        ``(m, 3)``; returned unchanged if nothing is flipped.
    held
        ``(n,)`` mask of fixed vertices.
    creases
        ``(c, 2)`` edges that are not flipped.
    """
    flat = flat_corners(faces, held)
    if not len(flat):
        return faces
    n, (u, v) = len(held), creases.T
    near = np.flatnonzero(np.isin(faces, faces[flat]).any(axis=1))
    edges = diagonals(n, faces[near], np.minimum(u, v) * n + np.maximum(u, v))
    here, there = near[edges.one], near[edges.other]
    ways = np.column_stack([np.stack([here, there, *edges[2:]]), np.stack([there, here, edges.b, edges.a, edges.d, edges.c])]).T
    lying, found = set(flat.tolist()), faces.copy()
    turned: set[int] = set()
    for one, other, a, b, c, d in ways.tolist():
        if one in lying and not held[d] and not {one, other} & turned and _turns(vertices[[a, b, c]]):
            turned |= {one, other}
            found[one], found[other] = (a, d, c), (d, b, c)
    return found if turned else faces


def _turns(corners: FloatArray) -> bool:
    """Check whether a triangle (3, 3) cuts off its last corner and its first edge can be flipped."""
    a, b, c = corner_angles(corners, np.arange(3)[None])[0].tolist()
    return bool(c < MAX_CORNER and max(a, b) < MAX_SIDE_ANGLE)
