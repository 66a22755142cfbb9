"""Smoothed vertex normals, as directions for long moves."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from ...discrete import _kernels
from ...discrete.arrays import Faces
from ...discrete.arrays import Vectors
from ...discrete.arrays import Vertices

__all__ = ["smooth_normals"]


@njit(cache=True)
def smooth_normals(vertices: Vertices, faces: Faces, times: int) -> Vectors:
    """Return unit vertex normals, averaged `times` times over the corners of the faces around (n, 3).

    On irregular meshes the plain normals scatter, and long moves along them fold the
    small triangles.
    """
    n = len(vertices)
    N = _kernels.sum_at_vertices(n, faces, _kernels.cross_vectors(vertices, faces))
    for time in range(times + 1):
        if time > 0:
            mean = np.zeros((len(faces), 3))
            for f in range(len(faces)):
                for c in range(3):
                    for x in range(3):
                        mean[f, x] += N[faces[f, c], x]
            N = _kernels.sum_at_vertices(n, faces, mean)
        for i in range(n):
            length = math.sqrt(N[i, 0] ** 2 + N[i, 1] ** 2 + N[i, 2] ** 2)
            if length > 0.0:
                for x in range(3):
                    N[i, x] /= length
    return N
