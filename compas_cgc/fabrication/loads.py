"""Nodal loads of a surface."""

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
    """Return the load at every vertex (n, 3) [F].

    Pressure is distributed by the circumcentric cells of faces (negative at obtuse angles). With these cells the forces in the
    folds around a vertex of constant K balance the pressure; with thirds of the faces the error on irregular meshes is about 10 %,
    whatever the resolution. Weight is distributed by thirds, so that no nodal weight is negative.
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
    # Cotangent at a corner times the squared opposite edge.
    opposite = dot * (dot.sum(axis=1, keepdims=True) - dot)
    double = np.linalg.norm(np.cross(ahead[:, 0], back[:, 0]), axis=1)[:, None]
    return np.asarray((opposite.sum(axis=1, keepdims=True) - opposite) / (8.0 * double), dtype=np.float64)
