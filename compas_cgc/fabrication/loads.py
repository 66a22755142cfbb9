"""Loads of the vertices of a surface."""

from __future__ import annotations

import numpy as np

from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Vectors
from ..discrete.arrays import Vertices

__all__ = ["nodal_load"]


def nodal_load(vertices: Vertices, faces: Faces, pressure: float, weight: float) -> Vectors:
    """Return the load at every vertex (n, 3) [F], in all that on the faces.

    Pressure on the part of a face that is nearest to a vertex (its circumcentric cell, negative beyond right angles) is that vertex's:
    for that cell the folds around a vertex of constant K are in balance, `pressure` times the angle defect over K, while thirds of
    irregular faces miss it by a tenth on any mesh, however fine. Weight goes by thirds, so that none of it is lifted.
    """
    normals, areas = face_normals(vertices, faces), face_areas(vertices, faces)
    down = np.array([0.0, 0.0, -weight]) * areas[:, None] / 3.0
    each = pressure * _cells(vertices, faces)[:, :, None] * normals[:, None] + down[:, None]
    total = np.zeros((len(vertices), 3))
    np.add.at(total, faces, each)
    return total


def _cells(vertices: Vertices, faces: Faces) -> FloatArray:
    """Return the circumcentric part of every face at each of its corners (m, 3) [L^2]."""
    corners = vertices[faces]
    ahead, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    dot = np.einsum("ijk,ijk->ij", ahead, back)
    # The cotangent at a corner times the square of the edge opposite to it, which its two ends share.
    opposite = dot * (dot.sum(axis=1, keepdims=True) - dot)
    double = np.linalg.norm(np.cross(ahead[:, 0], back[:, 0]), axis=1)[:, None]
    return np.asarray((opposite.sum(axis=1, keepdims=True) - opposite) / (8.0 * double), dtype=np.float64)
