"""What lies at a place of a mesh."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ...datastructures import CGCMesh
from ...discrete.arrays import FloatArray
from ...errors import ProblemError
from ...meshing.point_location import face_at

__all__ = ["region_at", "vertices_at"]


def vertices_at(vertices: FloatArray, points: FloatArray, tolerance: float) -> list[int]:
    """Return the vertices (n, 3) at points (k, 3) [L].

    Raises
    ------
    ProblemError
        With a sentence for every point that is farther than the tolerance [L] from all.
    """
    if not len(points):
        return []
    distance, nearest = cKDTree(vertices).query(points)
    far = np.flatnonzero(~(distance <= tolerance))
    if len(far):
        raise ProblemError(
            [f"the point {i} is {distance[i]:.3g} away from the nearest vertex of the mesh; put it on a vertex" for i in far]
        )
    return sorted(set(nearest.tolist()))


def region_at(mesh: CGCMesh, point: FloatArray) -> int:
    """Return the region at, above or below a point (3,) [L]."""
    vertices, faces = mesh.arrays()
    real = [face for face in mesh.faces() if not any(mesh.is_dummy(v) for v in mesh.face_vertices(face))]
    face = real[face_at(np.asarray(point, dtype=np.float64), vertices, faces)[0]]
    return next(number for number, members in enumerate(mesh.regions()) if face in set(members))
