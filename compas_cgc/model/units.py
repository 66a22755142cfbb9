"""Units of drawings, and lengths with units."""

from __future__ import annotations

import math
import re
from typing import Any
from typing import NamedTuple
from typing import Optional
from typing import Union
from typing import overload

from ..errors import CGCError

__all__ = ["LONGEST_TEXT", "METRES", "UNIT_SYMBOLS", "GivenLength", "Length", "length_of", "millimetres_of", "within"]

# length of one drawing unit in metres [m]; by definition
METRES = {"Millimeters": 1e-3, "Centimeters": 1e-2, "Meters": 1.0, "Kilometers": 1e3, "Inches": 0.0254, "Feet": 0.3048, "Yards": 0.9144}
UNIT_SYMBOLS = {"Millimeters": "mm", "Centimeters": "cm", "Meters": "m", "Kilometers": "km", "Inches": "in", "Feet": "ft", "Yards": "yd"}
LONGEST_TEXT = 60  # characters of a length; longer texts are no lengths, and would slow down the regular expression
_SUFFIXES = {symbol: METRES[name] for name, symbol in UNIT_SYMBOLS.items()}


class Length(NamedTuple):
    """A length with its unit."""

    value: float
    metres: float  # of its unit

    def within(self, units: Optional[str]) -> float:
        """Return the length in the units of a drawing, such as ``Millimeters``, by default metres [L].

        Raises
        ------
        CGCError
            If the drawing has other units.
        """
        if units and units not in METRES:
            raise CGCError(f"the drawing is in {units}, to which lengths are not converted; give them as numbers in these units")
        return self.value * (self.metres / METRES[units or "Meters"])


GivenLength = Union[float, Length]  # a number in the units of the drawing, or a length with its unit


def length_of(value: object, what: str) -> GivenLength:
    """Return a length from a number or a text such as ``0.35`` or ``350mm``.

    Raises
    ------
    CGCError
        If it is not finite, or has an unknown unit.

    Examples
    --------
    >>> length_of("350 mm", "the edge length").within("Millimeters"), length_of("0.35", "the edge length")
    (350.0, 0.35)
    """
    text = value.strip() if isinstance(value, str) and len(value) <= LONGEST_TEXT else ""
    found = re.fullmatch(r"([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)\s*([a-zA-Z\"']*)", text)
    unit = found.group(2).casefold() if found else ""
    try:
        number = math.nan if isinstance(value, str) and not found else float(found.group(1) if found else value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if isinstance(value, bool) or not math.isfinite(number):
        raise CGCError(f"{what} must be a length, such as 0.35 or 350mm, not {value!r:.60}")
    if unit and unit not in _SUFFIXES:
        raise CGCError(f"{what} has the unknown unit {unit!r}; use {', '.join(_SUFFIXES)}, or none for the units of the file")
    return Length(number, _SUFFIXES[unit]) if unit else number


def millimetres_of(value: object, what: str) -> float:
    """Return a length in millimetres, from a number of millimetres or a text with another unit such as ``0.6cm``."""
    return within(length_of(value, what), "Millimeters")


@overload
def within(value: GivenLength, units: Optional[str]) -> float: ...
@overload
def within(value: Optional[GivenLength], units: Optional[str]) -> Optional[float]: ...
@overload
def within(value: list[GivenLength], units: Optional[str]) -> list[float]: ...
@overload
def within(value: Any, units: Optional[str]) -> Any: ...
def within(value: Any, units: Optional[str]) -> Any:
    """Return a length, or a list that may hold lengths, in the units of a drawing; other values are returned as they are."""
    if isinstance(value, Length):
        return value.within(units)
    return [within(part, units) for part in value] if isinstance(value, list) else value
