"""Parsing of option values from command lines and JSON."""

from __future__ import annotations

import math
import numbers
import re
from typing import NamedTuple
from typing import Optional
from typing import Union

from ..errors import CGCError
from ..model.units import LONGEST_TEXT
from ..model.units import UNIT_SYMBOLS
from ..model.units import GivenLength
from ..model.units import Length
from ..model.units import length_of
from ..model.units import millimetres_of
from ..model.units import within

__all__ = [
    "ALONG",
    "DRAWING_UNITS",
    "LARGEST",
    "NET_KINDS",
    "PAPERS",
    "Sheet",
    "length",
    "millimetres",
    "number",
    "paths",
    "plan_lines",
    "plan_vector",
    "points",
    "region_numbers",
    "sheet",
    "sheets",
    "strain",
    "text",
    "truth",
    "whole",
    "widths",
]

LARGEST = 1e9
LARGEST_STRAIN = 0.05  # metals and timber break or buckle long before; a larger number is meant in percent
ALONG = ("plan", "curvature")  # coordinates that a grid of panels may follow
NET_KINDS = ("curvature", "asymptotic")  # curves that a net may be made of in all regions
PAPERS = ("A4", "A3", "A2", "A1", "A0")  # from the smallest
DRAWING_UNITS = {UNIT_SYMBOLS[name]: name for name in ("Millimeters", "Centimeters", "Meters", "Inches", "Feet")}  # of files


class Sheet(NamedTuple):
    """Length and width of a sheet."""

    length: GivenLength
    width: GivenLength

    def within(self, units: Optional[str]) -> tuple[float, float]:
        """Return length and width in the units of a drawing, such as ``Meters`` [L]."""
        return within(self.length, units), within(self.width, units)


# Each reader takes a value and its name for messages, and raises CGCError.


def number(value: object, what: str) -> float:
    """Return a finite number up to LARGEST."""
    found = _as_float(value)
    if found is None or abs(found) > LARGEST:
        raise CGCError(f"{what} must be a number up to {LARGEST:g}, not {_short(value)}")
    return found


def length(value: object, what: str) -> GivenLength:
    """Return a length up to LARGEST in the units of the drawing, or with its unit, such as ``350mm``."""
    found = length_of(value, what)
    number(found.value if isinstance(found, Length) else found, what)
    return found


def millimetres(value: object, what: str) -> float:
    """Return a length up to LARGEST in millimetres, without a unit or with another one."""
    return number(millimetres_of(value, what), what)


def whole(value: object, what: str) -> int:
    """Return a whole number."""
    found = _as_float(value)
    if found is None or found != int(found) or abs(found) > LARGEST:
        raise CGCError(f"{what} must be a whole number, not {_short(value)}")
    return int(found)


def text(value: object, what: str) -> str:
    """Return a text."""
    if not isinstance(value, str) or len(value) > 200:
        raise CGCError(f"{what} must be a text of at most 200 characters, not {_short(value)}")
    return value


def truth(value: object, what: str) -> bool:
    """Return a boolean; accepts ``true`` and ``false`` as text."""
    found = {"true": True, "false": False}.get(value) if isinstance(value, str) else value
    if not isinstance(found, bool):
        raise CGCError(f"{what} must be true or false, not {_short(value)}")
    return found


def sheet(value: object, what: str) -> Sheet:
    """Return a sheet such as ``3.0x1.5``, ``3000x1500mm`` or ``[3.0, 1.5]``."""
    parts, unit = (list(value), None) if isinstance(value, (list, tuple)) else _of_sheet(value)
    length, width = map(_as_float, parts) if len(parts) == 2 else (None, None)
    if length is None or width is None:
        raise CGCError(f"{what} must be LENGTHxWIDTH, such as 3.0x1.5 or 3000x1500mm, not {_short(value)}")
    return Sheet(*(number if unit is None else length_of(f"{number!r}{unit}", what) for number in (length, width)))


def sheets(value: object, what: str) -> list[Sheet]:
    """Return one or several sheets, such as ``3.0x1.5,2.5x1.25``, ``[3.0, 1.5]`` or ``[[3.0, 1.5], [2.5, 1.25]]``."""
    if isinstance(value, str):
        return [sheet(part, what) for part in value.split(",")]
    if isinstance(value, (list, tuple)) and value and all(isinstance(part, (str, list, tuple)) for part in value):
        return [sheet(part, what) for part in value]
    return [sheet(value, what)]


def _of_sheet(value: object) -> tuple[list[str], Optional[str]]:
    """Return the numbers and the unit of a text such as ``3000x1500mm``; no numbers if it has another form."""
    text = value.strip() if isinstance(value, str) and len(value) <= LONGEST_TEXT else ""
    found = re.fullmatch(rf"([0-9.]+)\s*[x×X]\s*([0-9.]+)\s*({'|'.join(UNIT_SYMBOLS.values())})?", text)
    return ([found.group(1), found.group(2)], found.group(3)) if found else ([], None)


def strain(value: object, what: str) -> float:
    """Return a strain such as ``0.002`` or ``0.2%``."""
    body, percent, rest = value.partition("%") if isinstance(value, str) else (value, "", "")
    found = _as_float(body)
    if found is None or rest.strip():
        raise CGCError(f"{what} must be a number such as 0.002 or 0.2%, not {_short(value)}")
    if not percent and found > LARGEST_STRAIN:
        raise CGCError(
            f"{what} of {found:g} means {100 * found:g} %, which breaks any sheet; add a percent sign if {found:g}% was intended"
        )
    return found * (0.01 if percent else 1.0)


def paths(value: object, what: str) -> list[list[int]]:
    """Return paths of vertices: texts such as ``4,12,20``, or lists of numbers."""
    sentence = f"{what} must be the numbers of vertices, such as 4,12,20, not {_short(value)}"
    rows = [_numbers(row) for row in _rows(value)]
    if not rows or any(row is None or any(x != int(x) or not 0 <= x <= LARGEST for x in row) for row in rows):
        raise CGCError(sentence)
    return [[int(x) for x in row or ()] for row in rows]


def points(value: object, what: str) -> Union[str, list[list[float]]]:
    """Return points from texts such as ``1.0,2.0,0.5`` or lists of three numbers, or the word ``supports``."""
    rows = _rows(value)
    if rows == ["supports"]:
        return "supports"
    found = [_numbers(row) for row in rows]
    if not found or any(row is None or len(row) != 3 for row in found):
        said = " ".join(rows) if all(isinstance(row, str) for row in rows) else value
        raise CGCError(f"{what} must be X,Y,Z such as 1.0,2.0,0.5, or 'supports', not {_short(said)}")
    return [row for row in found if row is not None]


def widths(value: object, what: str) -> list[GivenLength]:
    """Return widths such as ``1.2``, ``0.8,1.2``, ``800mm,1200mm`` or ``[0.8, 1.2]``."""
    parts = value.split(",") if isinstance(value, str) else value if isinstance(value, (list, tuple)) else [value]
    sentence = f"{what} must be positive widths, such as 1.2 or 0.8,1.2, not {_short(value)}"
    try:
        found = [length(part, what) for part in parts]
    except CGCError:
        raise CGCError(sentence) from None
    if not found or min(within(found, "Meters")) <= 0.0:
        raise CGCError(sentence)
    return found


def plan_vector(value: object, what: str) -> list[float]:
    """Return a vector in plan such as ``0.5,0.2`` or ``[0.5, 0.2]``."""
    found = _numbers(value)
    if found is None or len(found) != 2:
        raise CGCError(f"{what} must be X,Y such as 0.5,0.0, not {_short(value)}")
    return found


def plan_lines(value: object, what: str) -> list[list[float]]:
    """Return lines in plan from texts such as ``0,2,8,2`` or lists of four numbers."""
    found = [_numbers(row) for row in _rows(value)]
    if not found or any(row is None or len(row) != 4 for row in found):
        raise CGCError(f"{what} must be X,Y,X,Y such as 0,2,8,2, not {_short(value)}")
    return [row for row in found if row is not None]


def region_numbers(value: object, what: str) -> list[int]:
    """Return numbers of regions."""
    if not isinstance(value, (list, tuple)) or not value:
        raise CGCError(f"{what} must be numbers of regions, not {_short(value)}")
    return [whole(part, f"every region of {what}") for part in value]


def _rows(value: object) -> list:
    """Return rows; a single text or a flat list of numbers counts as one row."""
    if isinstance(value, str):
        return [value]
    if not isinstance(value, (list, tuple)):
        return []
    return [value] if value and all(_as_float(part) is not None for part in value) and not isinstance(value[0], str) else list(value)


def _numbers(row: object) -> Optional[list[float]]:
    parts = row.split(",") if isinstance(row, str) else row
    found = [_as_float(part) for part in parts] if isinstance(parts, (list, tuple)) else []
    numbers = [x for x in found if x is not None]
    return numbers if numbers and len(numbers) == len(found) else None


def _as_float(value: object) -> Optional[float]:
    """Return a finite number, also from text, None for other values."""
    if isinstance(value, bool) or not isinstance(value, (numbers.Real, str)):
        return None
    try:
        found = float(value)
    except (ValueError, OverflowError):
        return None
    return found if math.isfinite(found) else None


def _short(value: object) -> str:
    return f"{value!r:.60}"
