"""Smoothed vertex normals, as directions for long moves."""

from __future__ import annotations

from . import _kernels
from .arrays import Faces
from .arrays import Vectors
from .arrays import Vertices
from .normals import unit_vectors

__all__ = ["smooth_normals"]


def smooth_normals(vertices: Vertices, faces: Faces, times: int) -> Vectors:
    """Return unit vertex normals, averaged `times` times over the corners of the faces around (n, 3).

    On irregular meshes the plain normals scatter, and long moves along them fold the
    small triangles.
    """
    n = len(vertices)
    normals = unit_vectors(_kernels.sum_at_vertices(n, faces, _kernels.cross_vectors(vertices, faces)))
    for _ in range(times):
        normals = unit_vectors(_kernels.sum_over_corners(faces, normals))
    return normals
