"""Colours of values."""

from __future__ import annotations

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray

__all__ = ["NO_VALUE", "largest", "signed_colours"]

NO_VALUE = (190, 190, 190)
_STOPS = np.array([[8, 48, 107], [43, 123, 186], [166, 203, 227], [255, 255, 255], [246, 178, 154], [214, 64, 58], [127, 13, 26]])


def signed_colours(values: FloatArray, limit: float) -> IntArray:
    """Return colours of values from -limit (blue) over 0 (white) to limit (red): (n, 3) in 0..255, grey for NaN."""
    known = np.isfinite(values)
    share = np.clip(np.where(known, values, 0.0) / limit, -1.0, 1.0)
    place = 0.5 * (share + 1.0) * (len(_STOPS) - 1)
    colours = np.column_stack([np.interp(place, np.arange(len(_STOPS)), _STOPS[:, channel]) for channel in range(3)])
    return np.where(known[:, None], np.rint(colours), NO_VALUE).astype(np.int64)


def largest(values: FloatArray) -> float:
    """Return the largest finite ``|value|``, or 1 if all are zero."""
    size = np.abs(values[np.isfinite(values)])
    return float(size.max(initial=0.0)) or 1.0
