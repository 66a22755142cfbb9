"""Figures for the workshop: lengths in millimetres, areas in square metres."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..model.units import METRES
from ..model.units import UNIT_SYMBOLS

__all__ = ["SHORT", "in_mm", "in_square_metres", "metres", "on_most_of_the_area", "two_digits", "unit_symbol"]

SHORT = 0.1  # length of seams and beams below which they are named [m]
AREA_SHARE = 0.95  # on which a figure is stated; curvature and stress are unbounded at point supports


def metres(units: Optional[str]) -> float:
    """Return the length of the unit of a drawing [m]; a drawing without units is in metres."""
    return METRES.get(units or "Meters", 1.0)


def unit_symbol(units: Optional[str]) -> str:
    """Return the symbol of the unit of a drawing, such as ``mm``; a drawing without units is in metres."""
    return UNIT_SYMBOLS.get(units or "Meters", units or "m")


def in_mm(lengths: Sequence[float], units: Optional[str]) -> str:
    """Return lengths as text in millimetres, such as ``3000 x 1500 mm``."""
    scale = 1000.0 * metres(units)
    return " x ".join(f"{length * scale:.1f}".removesuffix(".0") for length in lengths) + " mm"


def in_square_metres(area: float, units: Optional[str]) -> str:
    """Return an area as text in square metres with three decimals, such as ``4.125``."""
    return f"{area * metres(units) ** 2:.3f}"


def on_most_of_the_area(values: FloatArray, areas: FloatArray) -> float:
    """Return the least number that values of faces (m,) with areas (m,) do not exceed on 95 % of the area."""
    order = np.argsort(values, kind="stable")
    return float(values[order][np.searchsorted(np.cumsum(areas[order]), AREA_SHARE * areas.sum())])


def two_digits(value: float) -> str:
    """Return a number with two significant digits, or rounded to an integer from 100."""
    return f"{value:.2g}" if abs(value) < 99.5 else f"{value:.0f}"
