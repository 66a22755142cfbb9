"""Extent of points in space."""

from __future__ import annotations

import numpy as np

from .arrays import FloatArray

__all__ = ["diameter"]


def diameter(points: FloatArray) -> float:
    """Return the largest distance between two points, which does not depend on how they are turned [L].

    The farthest point from the last one is taken until distances grow no more, which finds the diagonals of rectangles, and for other
    outlines a chord that no single point can lengthen.

    Parameters
    ----------
    points
        ``(n, 3)`` points, at least one [L].
    """
    last, found = points.mean(axis=0), 0.0
    while True:
        away = np.linalg.norm(points - last, axis=1)
        last, longer = points[np.argmax(away)], float(away.max())
        if not longer > found:
            return found
        found = longer
