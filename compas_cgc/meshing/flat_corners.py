"""Corners of held edges, and faces that lie flat in them: the other diagonal is the one to read curvature across."""

from __future__ import annotations

import numpy as np

from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.corners import corner_angles
from ..discrete.topology import boundary_mask
from .edge_flips import diagonals

__all__ = ["flat_corners", "has_corners", "turned_corners"]

BLUNT = np.radians(150.0)  # angle of a corner from which a face in it cuts off next to nothing
WIDE = np.radians(75.0)  # angle at its other ends from which the face across may be none that turns


def flat_corners(faces: IntArray, held: Mask) -> IntArray:
    """Return the triangles that lie flat in corners (k,): all three vertices are held, and one has no other face.

    Parameters
    ----------
    faces
        ``(m, 3)``.
    held
        ``(n,)`` vertices that stay where they are.
    """
    still = np.flatnonzero(held[faces].all(axis=1))
    alone = np.bincount(faces.ravel(), minlength=len(held)) == 1
    return still[alone[faces[still]].any(axis=1)]


def turned_corners(vertices: FloatArray, faces: IntArray, held: Mask, creases: Edges) -> IntArray:
    """Return triangles (m, 3) of which those that lie flat in corners are turned with their neighbours: their edge leads into the corner.

    Such a face cuts its corner off, whatever the surface beside it. What is turned follows from vertices that are held alone, so that it
    is the same over all surfaces of a drawing.

    Parameters
    ----------
    vertices
        ``(n, 3)`` [L].
    faces
        ``(m, 3)``; themselves where none is turned.
    held
        ``(n,)`` vertices that stay where they are.
    creases
        ``(c, 2)`` edges that stay.
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


def has_corners(vertices: FloatArray, faces: IntArray, held: Mask) -> bool:
    """Return whether a held edge makes a corner that is no blunt one.

    Parameters
    ----------
    vertices
        ``(n, 3)`` [L].
    faces
        ``(m, 3)``.
    held
        ``(n,)`` vertices that stay where they are.
    """
    n = len(held)
    within = np.bincount(faces.ravel(), corner_angles(vertices, faces).ravel(), n)
    return bool((held & boundary_mask(n, faces) & (within < BLUNT)).any())


def _turns(corners: FloatArray) -> bool:
    """Return whether a triangle (3, 3) cuts something off at its last corner, and can be turned about its first edge whatever is beyond."""
    a, b, c = corner_angles(corners, np.arange(3)[None])[0].tolist()
    return bool(c < BLUNT and max(a, b) < WIDE)
