"""Optimal triangulation of small polygons by dynamic programming (Klincsek)."""

from __future__ import annotations

import numpy as np

from ..discrete.arrays import FloatArray

__all__ = ["best_triangles"]


def best_triangles(points: FloatArray, ring: list[int]) -> list[list[int]]:
    """Return the triangulation of a polygon whose worst triangle is best.

    Parameters
    ----------
    points
        ``(n, 3)`` coordinates [L].
    ring
        Vertices around the polygon; some may lie on straight sides.

    Returns
    -------
    list of [int, int, int]
        Triangles in the same orientation.

    References
    ----------
    Klincsek, Minimal triangulations of polygonal domains (1980).
    """
    n = len(ring)
    if n == 3:
        return [ring]
    P = points[ring]
    normal = np.cross(P, np.roll(P, -1, axis=0)).sum(axis=0)
    best = {(i, i + 1): (np.inf, -1) for i in range(n - 1)}
    for width in range(2, n):
        for i in range(n - width):
            j = i + width
            best[i, j] = max((min(best[i, k][0], best[k, j][0], _quality(P[[i, k, j]], normal)), k) for k in range(i + 1, j))
    triangles, open_ = [], [(0, n - 1)]
    while open_:
        i, j = open_.pop()
        if j - i > 1:
            k = best[i, j][1]
            triangles.append([ring[i], ring[k], ring[j]])
            open_ += [(k, j), (i, k)]
    return triangles


def _quality(P: FloatArray, normal: FloatArray) -> float:
    """Return the signed area over the squared longest side: small for slivers, negative at concave corners."""
    area = float(np.dot(np.cross(P[1] - P[0], P[2] - P[0]), normal))
    return area / float(max(np.dot(d, d) for d in P - np.roll(P, 1, axis=0)))
