"""Plans in space."""

from __future__ import annotations

import numpy as np

from .arrays import FloatArray

__all__ = ["cross", "flattened", "rectangles"]


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the cross products (k,) of vectors in plan (k, 2), positive where the second lies to the left of the first."""
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def flattened(points: FloatArray) -> FloatArray:
    """Return points (n, 2) or (n, 3) at the height 0 (n, 3)."""
    return np.column_stack([points[:, :2], np.zeros(len(points))])


def rectangles(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the directions (s, 2) and the areas (s,) [L^2] of the rectangles around points (k, 2) with a side along their hull.

    The smallest rectangle around the points is one of them.

    References
    ----------
    Freeman and Shapira, doi:10.1145/360881.360919.
    """
    from scipy.spatial import ConvexHull

    hull = points[ConvexHull(points).vertices]
    sides = np.roll(hull, -1, axis=0) - hull
    along = sides / np.linalg.norm(sides, axis=1)[:, None]
    across = np.column_stack([-along[:, 1], along[:, 0]])
    return along, np.asarray(np.ptp(hull @ along.T, axis=0) * np.ptp(hull @ across.T, axis=0))
