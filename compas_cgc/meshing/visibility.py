"""Visibility of points of lines and marks."""

from __future__ import annotations

import numpy as np

from .._compiled import kernel
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask

__all__ = ["in_sight"]

TOLERANCE = 2e-3  # depth difference below which a face does not hide a point, relative to the size of the model


def in_sight(points: FloatArray, corners: FloatArray, faces: Faces) -> Mask:
    """Return a mask of the points that no face hides.

    Parameters
    ----------
    points
        ``(k, 3)`` projected coordinates, and nearness [L].
    corners
        ``(n, 3)`` projected vertices, and nearness [L].
    faces
        ``(m, 3)`` vertex indices.

    Returns
    -------
    (k,) bool
    """
    size = float(np.ptp(corners[faces.ravel()], axis=0).max()) if len(faces) else 0.0
    return _in_sight(points, corners, faces, TOLERANCE * size)


@kernel()
def _in_sight(P: FloatArray, V: FloatArray, F: Faces, tolerance: float) -> Mask:
    free = np.ones(len(P), np.bool_)
    for f in range(len(F)):
        a, b, c = V[F[f, 0]], V[F[f, 1]], V[F[f, 2]]
        twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if twice == 0.0:
            continue
        left, right = min(a[0], b[0], c[0]), max(a[0], b[0], c[0])
        bottom, top = min(a[1], b[1], c[1]), max(a[1], b[1], c[1])
        near = max(a[2], b[2], c[2])
        for i in range(len(P)):
            x, y, z = P[i]
            if not free[i] or x < left or x > right or y < bottom or y > top or z + tolerance >= near:
                continue
            u = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / twice
            v = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / twice
            w = 1.0 - u - v
            if u >= 0 and v >= 0 and w >= 0 and u * a[2] + v * b[2] + w * c[2] > z + tolerance:
                free[i] = False
    return free
