"""Delaunay flips on a surface mesh: edges are flipped until opposite angles add up to at most π."""

from __future__ import annotations

import numpy as np

from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.corners import corner_angles
from .edge_flips import Diagonals
from .edge_flips import diagonals

__all__ = ["delaunay_turned", "obtuse_share", "turnable"]

SWEEPS = 40
OBTUSE_ANGLE = np.radians(120.0)
ANGLE_TOLERANCE = 1e-3  # excess of opposite angles over π that counts as zero [rad]
MAX_TURN = 0.97  # angle of both triangles at an end of their edge, relative to π, above which the edge is not flipped


def obtuse_share(vertices: FloatArray, faces: IntArray) -> float:
    """Return the share of triangles (m, 3) with an angle of more than 120 degrees."""
    return float((corner_angles(vertices, faces).max(axis=1) > OBTUSE_ANGLE).mean()) if len(faces) else 0.0


def delaunay_turned(vertices: FloatArray, faces: IntArray, creases: Edges) -> IntArray:
    """Return triangles (m, 3) on the same vertices with edges flipped where opposite angles add up to more than π.

    Angle defects of stretched triangles approximate the curvature of a surface badly; those of Delaunay triangles are the most
    accurate.

    Parameters
    ----------
    vertices
        ``(n, 3)`` [L].
    faces
        ``(m, 3)``.
    creases
        ``(c, 2)`` edges that are not flipped.

    References
    ----------
    Bobenko and Springborn, *A discrete Laplace-Beltrami operator for simplicial surfaces*, doi:10.1007/s00454-007-9006-1.
    """
    n, faces = len(vertices), faces.copy()
    u, v = creases.T
    kept = np.minimum(u, v) * n + np.maximum(u, v)

    for _ in range(SWEEPS):
        edges = diagonals(n, faces, kept)
        _, _, a, b, c, d = edges
        excess = _angle(vertices, c, a, b) + _angle(vertices, d, a, b) - np.pi
        good = np.flatnonzero((excess > ANGLE_TOLERANCE) & turnable(vertices, faces, edges))
        if not len(good):
            break
        busy = np.zeros(n, bool)
        for k in good[np.argsort(-excess[good], kind="stable")].tolist():
            ends = [a[k], b[k], c[k], d[k]]
            if not busy[ends].any():
                busy[ends] = True
                faces[edges.one[k]], faces[edges.other[k]] = (a[k], d[k], c[k]), (d[k], b[k], c[k])
    return faces


def turnable(vertices: FloatArray, faces: IntArray, edges: Diagonals) -> Mask:
    """Return which edges (k,) of triangles (m, 3) may be flipped without inverting a triangle or duplicating an edge."""
    n, (_, _, a, b, c, d) = len(vertices), edges
    at_a = _angle(vertices, a, c, b) + _angle(vertices, a, b, d)
    at_b = _angle(vertices, b, c, a) + _angle(vertices, b, a, d)
    known = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1) @ [n, 1]
    return (np.maximum(at_a, at_b) < MAX_TURN * np.pi) & ~np.isin(np.minimum(c, d) * n + np.maximum(c, d), known)


def _angle(vertices: FloatArray, at: IntArray, one: IntArray, other: IntArray) -> FloatArray:
    u, v = vertices[one] - vertices[at], vertices[other] - vertices[at]
    crossed = np.cross(u, v)
    return np.asarray(np.arctan2(np.sqrt((crossed * crossed).sum(axis=1)), (u * v).sum(axis=1)))
