"""Plans in space."""

from __future__ import annotations

import numpy as np

from .arrays import FloatArray

__all__ = ["cross", "flattened"]


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the cross products (k,) of vectors in plan (k, 2), positive where the second lies to the left of the first."""
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def flattened(points: FloatArray) -> FloatArray:
    """Return points (n, 2) or (n, 3) at the height 0 (n, 3)."""
    return np.column_stack([points[:, :2], np.zeros(len(points))])
