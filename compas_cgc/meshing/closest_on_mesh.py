"""Closest points on a mesh of triangles."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from .point_location import closest_in_triangles

__all__ = ["nearest_on_mesh"]


def nearest_on_mesh(points: FloatArray, vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return the nearest points of a mesh to points (k, 3) [L], and the unit normals of their faces (k, 3)."""
    triangles = vertices[faces]
    middle = triangles.mean(axis=1)
    reach = float(np.linalg.norm(triangles - middle[:, None], axis=2).max())
    tree = cKDTree(middle)
    # The centre of the nearest face is at most the radius of a face farther away than the nearest centre.
    lists = tree.query_ball_point(points, tree.query(points)[0] + reach * (1.0 + 1e-12))
    owner = np.repeat(np.arange(len(points)), [len(own) for own in lists])
    face = np.concatenate([np.sort(own) for own in lists]).astype(np.int64) if len(points) else np.empty(0, np.int64)
    places = closest_in_triangles(points[owner], triangles[face])
    distance = np.linalg.norm(places - points[owner], axis=1)
    order = np.lexsort((distance, owner))
    first = order[np.searchsorted(owner[order], np.arange(len(points)))]
    a, b, c = (triangles[face[first], k] for k in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return places[first], normals / np.where(lengths > 0.0, lengths, 1.0)
