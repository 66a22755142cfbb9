"""Plans in space."""

from __future__ import annotations

import numpy as np

from .arrays import FloatArray

__all__ = ["flattened"]


def flattened(points: FloatArray) -> FloatArray:
    """Return points (n, 2) or (n, 3) at the height 0 (n, 3)."""
    return np.column_stack([points[:, :2], np.zeros(len(points))])
