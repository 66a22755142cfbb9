"""Single precision: how far coordinates are off that have been rounded to seven digits."""

from __future__ import annotations

import numpy as np

from ...discrete.arrays import FloatArray

__all__ = ["rounding_of"]


def rounding_of(vertices: FloatArray, double: bool) -> float:
    """Return the error that single precision has left in coordinates (n, 3) [L], 0 where it has left none.

    Doubles too may have been singles before: when none has more digits, and some are no
    short decimals by design.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    double
        Whether they come as doubles.
    """
    if double and not _are_singles(vertices):
        return 0.0
    return float(np.abs(vertices).max(initial=0.0)) * 2.0**-24


def _are_singles(vertices: FloatArray) -> bool:
    with np.errstate(over="ignore"):
        single = vertices.astype(np.float32)
    return bool((vertices == single).all() and (vertices != np.round(vertices, 6)).any())
