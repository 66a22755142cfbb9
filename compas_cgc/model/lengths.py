"""Lengths and places as text, with the digits that matter for a model of a size, wherever it lies."""

from __future__ import annotations

import math
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from .tolerances import NEGLIGIBLE
from .units import UNIT_SYMBOLS

__all__ = ["length_text", "place_text", "unit_suffix"]

DIGITS = 4  # significant digits of lengths; a millimetre in ten metres
LARGEST_PLAIN = 1e15  # value from which lengths have an exponent; above 2**53 digits are not exact


def unit_suffix(name: Optional[str]) -> str:
    """Return the suffix of a length in a unit such as ``Millimeters``: `` mm``; empty for units without an abbreviation."""
    return f" {UNIT_SYMBOLS[name]}" if name in UNIT_SYMBOLS else ""


def length_text(value: float, size: float) -> str:
    """Return a length with four digits, and more where a coordinate is larger than the size of its model [L].

    Examples
    --------
    >>> length_text(2.33912, 20.0), length_text(3530000.256, 20.0), length_text(2e149, 3e149)
    ('2.339', '3530000.26', '2e+149')
    """
    if not math.isfinite(value):
        return str(value)
    if abs(value) <= NEGLIGIBLE * size:
        return "0"
    digits = DIGITS + (max(0, math.floor(math.log10(abs(value))) - math.floor(math.log10(size))) if 0.0 < size < math.inf else 0)
    if not 10.0**-DIGITS <= abs(value) < LARGEST_PLAIN:
        return f"{value:.{digits}g}"
    return np.format_float_positional(value, digits, unique=False, fractional=False, trim="-")


def place_text(point: FloatArray, size: float) -> str:
    """Return a point (3,) of a model of a size as text, such as ``(1, 2.5, 0)`` [L]."""
    return f"({', '.join(length_text(x, size) for x in point.tolist())})"
