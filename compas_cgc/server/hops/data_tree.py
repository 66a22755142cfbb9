"""Grasshopper data trees in the JSON of Hops."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from decimal import Decimal
from typing import Any
from typing import Callable
from typing import Optional

import numpy as np

from ..api.decoding import LARGEST
from ..api.decoding import number
from ..api.decoding import whole
from ..api.decoding import whole_text
from ..errors import TooLarge
from ..errors import Unprocessable
from .schema import RESULT_TYPES
from .schema import Endpoint
from .schema import Input

__all__ = ["format_number", "entry", "finite_items", "passed_over", "read_values", "format_text"]


def read_values(endpoint: Endpoint, values: object) -> dict:
    """Return the inputs of a request by name; geometry remains encoded.

    Raises
    ------
    Unprocessable
        If an input is empty, of the wrong type or out of range.
    """
    if not isinstance(values, list) or not all(isinstance(item, dict) for item in values):
        raise Unprocessable("'values' must be a list of inputs")
    trees = {str(item.get("ParamName")).lower(): item.get("InnerTree") for item in values}
    return {own.name: _input(own, trees.get(own.name.lower())) for own in endpoint.inputs}


def passed_over(endpoint: Endpoint, values: object) -> list[str]:
    """Return a warning for every input that takes one item but has several."""
    trees = {str(item.get("ParamName")).lower(): item.get("InnerTree") for item in values} if isinstance(values, list) else {}
    counts = {own.name: len(_items(own.name, trees.get(own.name.lower()))) for own in endpoint.inputs if not own.many}
    return [
        f"input '{name}' takes one item but has {count}; only the first was used; send the others in separate requests"
        for name, count in counts.items()
        if count > 1
    ]


def _input(own: Input, tree: object) -> object:
    items = _items(own.name, tree)
    if not items:
        if own.many and own.optional:
            return []
        if own.default is None:
            raise Unprocessable(f"input '{own.name}' is empty; connect a {own.kind.lower()} to it")
        return own.default
    if not own.many:
        return _read(own, items[0])
    if len(items) > own.most:
        raise TooLarge(f"input '{own.name}' has {len(items)} items; the server accepts at most {own.most}; connect fewer")
    return [_read(own, item) for item in items]


def _items(name: str, tree: object) -> list[dict]:
    """Return the items of all branches in the order of their paths."""
    if tree is None:
        return []
    if not isinstance(tree, dict) or not all(isinstance(branch, list) for branch in tree.values()):
        raise Unprocessable(f"input '{name}' must be a tree of lists")
    items = [item for path in sorted(tree, key=lambda path: _path(name, path)) for item in tree[path]]
    if not all(isinstance(item, dict) for item in items):
        raise Unprocessable(f"input '{name}' must hold items with 'data'")
    full = [item for item in items if item.get("data") is not None]
    if full and len(full) < len(items):
        # Skipping an empty item would shift the assignment of the others.
        raise Unprocessable(f"input '{name}' has {len(items) - len(full)} empty items (null); remove them with Clean Tree")
    return full


def _path(name: str, text: str) -> tuple[int, ...]:
    try:
        return tuple(int(part[:20]) for part in text.strip("{} ").split(";") if part.strip())
    except ValueError:
        raise Unprocessable(f"input '{name}' has a branch {text!r:.40} that is not a path") from None


def _read(own: Input, item: dict) -> object:
    data = item["data"]
    what = f"input '{own.name}'"
    if own.kind == "Text":
        return _text(data, what)
    if isinstance(data, str):
        try:
            data = json.loads(data.lower() if own.kind == "Boolean" else data, parse_constant=lambda name: math.nan, parse_int=whole_text)
        except (ValueError, RecursionError):
            raise Unprocessable(f"{what} cannot be read as a {own.kind.lower()}; connect a {own.kind.lower()} to it") from None
    if own.kind == "Number":
        value: Any = number(data, what)
    elif own.kind == "Integer":
        value = whole(data, what)
    elif own.kind == "Boolean":
        if not isinstance(data, bool):
            raise Unprocessable(f"{what} must be true or false")
        return data
    elif own.kind == "Point":
        return _point(data, what)
    else:
        if not isinstance(data, dict):
            raise Unprocessable(f"{what} must be a {own.kind.lower()}")
        return data
    if (own.low is not None and value < own.low) or (own.high is not None and value > own.high):
        range = f"from {own.low:g} up" if own.high is None else f"between {own.low:g} and {own.high:g}"
        raise Unprocessable(f"{what} must be {range}, not {value:g}")
    return value


def _text(data: object, what: str) -> str:
    if not isinstance(data, str):
        return json.dumps(data)
    try:
        inner = json.loads(data, parse_int=whole_text)
    except (ValueError, RecursionError):
        inner = data
    text = inner if isinstance(inner, str) else data
    try:
        text.encode()
    except UnicodeEncodeError:
        raise Unprocessable(f"{what} holds half of a surrogate pair, which is not valid text; correct it") from None
    return text


def _point(data: Any, what: str) -> tuple[float, float, float]:
    try:
        own = {str(name).lower(): value for name, value in data.items()}
        x, y, z = (number(own[axis], f"{axis} of a point of {what}") for axis in "xyz")
        return x, y, z
    except (AttributeError, KeyError):
        raise Unprocessable(f"{what} must hold points with X, Y and Z") from None


def entry(name: str, kind: str, items: Iterable[object]) -> dict:
    """Return an output with one branch of items, formatted independently of the culture of the client.

    Parameters
    ----------
    name
        Name of the output.
    kind
        Grasshopper's name of the type.
    items
        Numbers, booleans, strings, or geometry as JSON strings.
    """
    write = _WRITERS.get(kind, str)
    data = [{"type": ITEM_TYPES.get(kind, RESULT_TYPES[kind]), "data": write(item)} for item in items]
    return {"ParamName": name, "InnerTree": {"{0}": data} if data else {}}


def format_number(value: float) -> str:
    """Return a finite number as a string without a decimal point, which depends on the culture in Hops: 0.25 becomes 25E-2."""
    sign, digits, power = Decimal(repr(float(value))).as_tuple()
    exponent = int(power)
    text = "".join(map(str, digits))
    trimmed = text.rstrip("0")
    exponent += len(text) - len(trimmed)
    if not trimmed:
        return "0"
    if 0 < exponent <= 15 - len(trimmed):
        trimmed, exponent = trimmed + "0" * exponent, 0
    return f"{'-' * sign}{trimmed}" + (f"E{exponent}" if exponent else "")


def format_text(value: str) -> str:
    """Return a string, in quotes if recent Hops would read it as a number, boolean or null."""
    try:
        scalar = not isinstance(json.loads(value), (dict, list))
    except (ValueError, RecursionError):
        scalar = False
    return f'"{value}"' if scalar and not value.startswith('"') else value


def finite_items(values: np.ndarray) -> tuple[list[float], Optional[str]]:
    """Return all numbers; if some are not finite, an empty list and a warning, since dropping single items would shift the others."""
    if np.isfinite(values).all() and (np.abs(values) <= LARGEST**3).all():
        return values.tolist(), None
    return [], "the curvature is not finite at some vertices, so the output is empty; check the mesh for degenerate faces"


# Type names of outputs that differ from the name of the input type.
ITEM_TYPES = {"Curve": "Rhino.Geometry.PolylineCurve"}
_WRITERS: dict[str, Callable] = {
    "Number": format_number,
    "Boolean": lambda value: "true" if value else "false",
    "Text": format_text,
    "Point": lambda place: json.dumps(dict(zip("XYZ", place))),
}
