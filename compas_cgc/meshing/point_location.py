"""Point location: faces and vertices at given points."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import ProblemError

__all__ = ["closest_in_triangles", "face_at", "vertices_at"]


def closest_in_triangles(point: FloatArray, triangles: FloatArray) -> FloatArray:
    """Return the nearest point in each triangle (m, 3, 3) to a point (3,) or to one point per triangle (m, 3) [L]: (m, 3)."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    point = np.broadcast_to(point, a.shape)
    normal = np.cross(b - a, c - a)
    size2 = np.einsum("ij,ij->i", normal, normal)
    inside = size2 > 0
    best = np.empty_like(a)
    gap = np.full(len(a), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        along = q - p
        t = np.einsum("ij,ij->i", point - p, along) / np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
        place = p + np.clip(t, 0.0, 1.0)[:, None] * along
        distance = np.einsum("ij,ij->i", point - place, point - place)
        nearer = distance < gap
        best[nearer], gap[nearer] = place[nearer], distance[nearer]
        inside &= np.einsum("ij,ij->i", np.cross(along, point - p), normal) >= 0
    height = np.einsum("ij,ij->i", point - a, normal) / np.where(size2 > 0, size2, 1.0)
    best[inside] = point[inside] - height[inside, None] * normal[inside]
    return best


def face_at(place: FloatArray, vertices: FloatArray, faces: IntArray) -> tuple[int, float]:
    """Return the face to which a label at a point belongs, and the distance of the point from the mesh [L].

    A point within a mean edge length of the surface belongs to the nearest face. A point
    farther off, such as a text dot in the plan of a roof, belongs to the face vertically
    below or above it; its distance is then 0.
    """
    P = vertices[faces]
    edge = float(np.linalg.norm(P - np.roll(P, 1, axis=1), axis=2).mean())
    # The nearest face has a corner within two edge lengths of the nearest corner.
    corner = np.linalg.norm(vertices - place, axis=1)[faces].min(axis=1)
    near = np.flatnonzero(corner <= corner.min() + 2.0 * np.linalg.norm(P - np.roll(P, 1, axis=1), axis=2).max())
    gap = np.linalg.norm(closest_in_triangles(place, P[near]) - place, axis=1)
    nearest = int(near[np.argmin(gap)])
    if gap.min() <= edge:
        return nearest, 0.0
    distance = np.linalg.norm(closest_in_triangles(place, P) - place, axis=1)
    plan = np.array([1.0, 1.0, 0.0])
    off = np.linalg.norm(closest_in_triangles(place * plan, P * plan) - place * plan, axis=1)
    over = np.flatnonzero(off <= 1e-9 * edge)
    if not len(over):
        return nearest, float(distance[nearest])
    return int(over[np.argmin(distance[over])]), 0.0


def vertices_at(vertices: FloatArray, points: FloatArray, tolerance: float) -> list[int]:
    """Return the vertices (n, 3) at points (k, 3) [L].

    Raises
    ------
    ProblemError
        With a sentence for every point farther than the tolerance [L] from all vertices.
    """
    if not len(points):
        return []
    distance, nearest = cKDTree(vertices).query(points)
    far = np.flatnonzero(~(distance <= tolerance))
    if len(far):
        raise ProblemError([f"point {i} is {distance[i]:.3g} away from the nearest vertex of the mesh; move it to a vertex" for i in far])
    return sorted(set(nearest.tolist()))
