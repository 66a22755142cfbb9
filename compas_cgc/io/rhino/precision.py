"""Rounding error of coordinates stored in single precision."""

from __future__ import annotations

import numpy as np

from ...discrete.arrays import FloatArray

__all__ = ["rounding_of"]


def rounding_of(vertices: FloatArray, double: bool) -> float:
    """Return the rounding error of coordinates (n, 3) from single precision [L], 0 in double precision.

    Doubles also count as rounded if all of them are representable in single precision and some
    are not short decimals.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    double
        Whether the coordinates are stored as doubles.
    """
    if double and not _are_singles(vertices):
        return 0.0
    return float(np.abs(vertices).max(initial=0.0)) * 2.0**-24


def _are_singles(vertices: FloatArray) -> bool:
    with np.errstate(over="ignore"):
        single = vertices.astype(np.float32)
    return bool((vertices == single).all() and (vertices != np.round(vertices, 6)).any())
