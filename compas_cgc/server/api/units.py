"""Units of length by their abbreviations."""

from __future__ import annotations

__all__ = ["UNITS"]

UNITS = {
    "": None,
    "m": "Meters",
    "mm": "Millimeters",
    "cm": "Centimeters",
    "km": "Kilometers",
    "ft": "Feet",
    "in": "Inches",
    "yd": "Yards",
}
