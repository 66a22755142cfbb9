"""Nodal loads of a surface."""

from __future__ import annotations

import numpy as np

from ..discrete import face_normals
from ..discrete import vertex_areas
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Vectors
from ..discrete.arrays import Vertices

__all__ = ["nodal_load"]


def nodal_load(vertices: Vertices, faces: Faces, pressure: float, weight: float) -> Vectors:
    """Return the load at every vertex (n, 3) [F].

    Pressure is distributed by the circumcentric cells of faces (negative at obtuse angles). With these cells the forces in the
    folds around a vertex of constant K balance the pressure; with thirds of the faces the error on irregular meshes is about 10 %,
    whatever the resolution. Weight is distributed by mixed cells, so that no nodal weight is negative. By thirds of the faces,
    neighbouring vertices of different valence would have different weights, a load that alternates with the mesh.
    """
    each = pressure * _cells(vertices, faces)[:, :, None] * face_normals(vertices, faces)[:, None]
    total = np.zeros((len(vertices), 3))
    np.add.at(total, faces, each)
    total[:, 2] -= weight * vertex_areas(vertices, faces, "mixed")
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
