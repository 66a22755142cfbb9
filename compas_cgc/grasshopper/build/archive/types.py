"""Types of values in Grasshopper files, in binary and XML form.

A value is a bool, int, float, str, bytes, UUID, Decimal or a tuple of numbers. A tuple holds
the fields of a structure in the order of :attr:`Type.fields`, the elements of an array, or
alpha, red, green and blue of a colour.
"""

from __future__ import annotations

import struct
import uuid
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

__all__ = ["BY_CODE", "TYPES", "Type", "Value"]

# A bool, int, float, str, bytes, UUID, Decimal or tuple, depending on the type of the item.
Value = Any


@dataclass(frozen=True)
class Type:
    """Type of a value in a file."""

    code: int
    name: str
    clean: Callable[[Any], Value]  # normalises a value to the form read from a file
    format: str = ""  # format of the struct module, empty for variable lengths
    fields: tuple[str, ...] = ()  # XML elements of a structure


def _bool(value: Any) -> bool:
    if not isinstance(value, (bool, int)) or value not in (0, 1):
        raise ValueError("it must be true or false")
    return bool(value)


def _whole(format: str) -> Callable[[Any], int]:
    def clean(value: Any) -> int:
        if isinstance(value, bool) or int(value) != value:
            raise ValueError("it must be an integer")
        return _packed(format, (int(value),))[0]

    return clean


def _single(value: Any) -> float:
    return _packed("<f", (float(value),))[0]


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise ValueError("it must be a string")
    value.encode("utf-8")
    return value


def _guid(value: object) -> uuid.UUID:
    return value if isinstance(value, uuid.UUID) else uuid.UUID(str(value))


def _decimal(value: object) -> Decimal:
    number = value if isinstance(value, Decimal) else Decimal(str(value))
    _, digits, exponent = number.as_tuple()
    if not isinstance(exponent, int):
        raise ValueError("it must be a finite number")
    scaled = int("".join(map(str, digits))) * 10 ** max(exponent, 0)
    if -exponent > 28 or scaled >= 1 << 96:
        raise ValueError("a decimal has at most 28 digits and 96 bits")
    return number if exponent <= 0 else number.quantize(Decimal(1))


def _doubles(value: Any) -> tuple[float, ...]:
    return tuple(float(x) for x in value)


def _colour(value: Any) -> tuple[int, ...]:
    parts = tuple(int(part) for part in value)
    if len(parts) != 4 or not all(0 <= part <= 255 for part in parts):
        raise ValueError("a colour is four numbers from 0 to 255")
    return parts


def _structure(format: str, count: int) -> Callable[[Any], tuple]:
    kind = int if "i" in format else float

    def clean(value: Any) -> tuple:
        parts = tuple(kind(part) for part in value)
        if len(parts) != count:
            raise ValueError(f"it must be {count} numbers")
        return _packed(format, parts)

    return clean


def _packed(format: str, values: tuple) -> tuple:
    try:
        return struct.unpack(format, struct.pack(format, *values))
    except struct.error as error:
        raise ValueError(str(error)) from None


def _fields(code: int, name: str, letter: str, fields: str) -> Type:
    names = tuple(fields.split())
    format = f"<{len(names)}{letter}"
    return Type(code, name, _structure(format, len(names)), format, names)


TYPES = {
    kind.name: kind
    for kind in (
        Type(1, "gh_bool", _bool, "<?"),
        Type(2, "gh_byte", _whole("<B"), "<B"),
        Type(3, "gh_int32", _whole("<i"), "<i"),
        Type(4, "gh_int64", _whole("<q"), "<q"),
        Type(5, "gh_single", _single, "<f"),
        Type(6, "gh_double", float, "<d"),
        Type(7, "gh_decimal", _decimal),
        Type(8, "gh_date", _whole("<q"), "<q"),
        Type(9, "gh_guid", _guid),
        Type(10, "gh_string", _text),
        Type(20, "gh_bytearray", bytes),
        Type(21, "gh_doublearray", _doubles),
        _fields(30, "gh_drawing_point", "i", "X Y"),
        _fields(31, "gh_drawing_pointf", "f", "X Y"),
        _fields(32, "gh_drawing_size", "i", "W H"),
        _fields(33, "gh_drawing_sizef", "f", "W H"),
        _fields(34, "gh_drawing_rectangle", "i", "X Y W H"),
        _fields(35, "gh_drawing_rectanglef", "f", "X Y W H"),
        Type(36, "gh_drawing_color", _colour),
        Type(37, "gh_drawing_bitmap", bytes),
        _fields(50, "gh_point2d", "d", "X Y"),
        _fields(51, "gh_point3d", "d", "X Y Z"),
        _fields(52, "gh_point4d", "d", "X Y Z W"),
        _fields(60, "gh_interval1d", "d", "A B"),
        _fields(61, "gh_interval2d", "d", "Au Bu Av Bv"),
        _fields(70, "gh_line", "d", "Ax Ay Az Bx By Bz"),
        _fields(71, "gh_boundingbox", "d", "Xmin Ymin Zmin Xmax Ymax Zmax"),
        _fields(72, "gh_plane", "d", "Ox Oy Oz Xx Xy Xz Yx Yy Yz"),
        _fields(80, "gh_version", "i", "Major Minor Revision"),
    )
}
BY_CODE = {kind.code: kind for kind in TYPES.values()}
