"""Serialization of constraints: the plain data that files, meshes and requests hold."""

from __future__ import annotations

import math
import numbers
from collections.abc import Iterable
from collections.abc import Mapping
from dataclasses import MISSING
from dataclasses import fields
from typing import Any
from typing import Callable
from typing import Union

import numpy as np

from ..errors import did_you_mean
from .constraints import CROWN
from .constraints import Constraint
from .constraints import Fixed
from .constraints import Height
from .constraints import Mirror
from .constraints import OnCurve
from .constraints import OnLine
from .constraints import OnPlane
from .constraints import Proximity
from .constraints import unit
from .goals.inequalities import Above
from .goals.inequalities import Below
from .goals.inequalities import Clearance
from .goals.inequalities import NearPlane
from .goals.inequalities import Within
from .goals.numbers import ALL
from .goals.numbers import FREE_EDGES
from .goals.places import EdgeInPlan
from .goals.places import Level
from .goals.places import OnSurface
from .goals.wholes import Area
from .goals.wholes import Length
from .goals.wholes import Rise
from .goals.wholes import Unknown
from .goals.wholes import Volume

__all__ = ["KINDS", "as_goals", "constraint_data", "constraint_of"]

KINDS: dict[str, type[Constraint]] = {
    "plane": OnPlane,
    "height": Height,
    "line": OnLine,
    "curve": OnCurve,
    "held": Fixed,
    "near": Proximity,
    "mirror": Mirror,
    "rise": Rise,
    "volume": Volume,
    "area": Area,
    "length": Length,
    "edge in plan": EdgeInPlan,
    "level": Level,
    "surface": OnSurface,
    "above": Above,
    "below": Below,
    "clearance": Clearance,
    "within": Within,
    "near plane": NearPlane,
    "unknown": Unknown,
}


def constraint_data(constraint: Constraint) -> dict[str, Any]:
    """Return a constraint as plain data: ``{"kind": ..., field: value, ...}`` with lists and numbers."""
    kind = next(name for name, own in KINDS.items() if type(constraint) is own)
    values = {field.name: getattr(constraint, field.name) for field in fields(constraint)}
    plain = {name: value if isinstance(value, bool) else np.asarray(value).tolist() for name, value in values.items()}
    return {"kind": kind, **{name: value for name, value in plain.items() if value is not None}}


def constraint_of(data: object) -> Constraint:
    """Return the constraint that plain data describes.

    Raises
    ------
    ValueError
        If the kind is unknown, or a field is missing, unknown or of the wrong type.
    """
    kind = data.get("kind") if isinstance(data, Mapping) else None
    if not isinstance(data, Mapping) or not isinstance(kind, str) or kind not in KINDS:
        meant = f", not {kind!r:.40}{did_you_mean(kind, KINDS)}" if isinstance(kind, str) else ""
        if isinstance(data, type):
            raise ValueError(f"a constraint is a value such as Rise(4.0){_written(data)}")
        value = f"; write a value such as Rise(4.0), not {data!r:.40}" if not isinstance(data, Mapping) else ""
        if kind is None and isinstance(data, Mapping):
            like = next((name for name in KINDS if name in data), "rise")
            written = {"kind": like, **data} if like in data else {"kind": like, like: 2.0}
            value = f"; write {written!r:.80}"
        raise ValueError(f"a constraint must be an object with a 'kind': {', '.join(KINDS)}{meant}{value}")
    own = fields(KINDS[kind])
    known = {field.name: field for field in own}
    values = {name: value for name, value in data.items() if name != "kind"}
    unknown = [name for name in values if name not in known]
    if unknown:
        raise ValueError(
            f"a constraint of kind {kind} has no field {unknown[0]!r:.40}; "
            f"its fields are {', '.join(known)}{did_you_mean(unknown[0], known)}"
        )
    missing = [field.name for field in own if field.name not in values and field.default is MISSING]
    if missing:
        raise ValueError(f"a constraint of kind {kind} needs {' and '.join(missing)}; its fields are {', '.join(known)}")
    readers = {**_READERS, **_OWN_READERS.get(kind, {})}
    return KINDS[kind](**{name: readers[name](value, f"{name} of a constraint of kind {kind}") for name, value in values.items()})


def as_goals(given: object) -> tuple[Constraint, ...]:
    """Return the goals in a list of goals and plain data; a single item counts as a list of one.

    Parameters
    ----------
    given
        A goal, its plain data, a list of these, or None.

    Raises
    ------
    ValueError
        If an item is not a constraint.
    """
    if isinstance(given, (Constraint, Mapping)):
        items: list[object] = [given]
    elif given is None or (isinstance(given, Iterable) and not isinstance(given, (str, type))):
        items = list(given or ())
    else:
        raise ValueError(f"goals must be a list such as [Rise(4.0)]{_written(given)}")
    return tuple(item if isinstance(item, Constraint) else constraint_of(item) for item in items)


def _written(given: object) -> str:
    """Return the end of the error message for an object that is not a constraint."""
    if isinstance(given, type) and issubclass(given, Constraint):
        return f"; {given.__name__} is a class: write {given.__name__}(...) with its values"
    return f", not {given!r:.40}"


def _number(value: object, name: str) -> float:
    if isinstance(value, bool) or not isinstance(value, numbers.Real) or not math.isfinite(value):
        raise ValueError(f"{name} must be a finite number")
    return float(value)


def _vertices(value: object, name: str) -> list[int]:
    return _whole_numbers(value, f"{name} must be a list of vertices, counted from 0")


def _whole_numbers(value: object, words: str) -> list[int]:
    if not isinstance(value, (list, tuple)) or not all(isinstance(v, numbers.Integral) and not isinstance(v, bool) for v in value):
        raise ValueError(words)
    return [int(v) for v in value]


def _regions(value: object, name: str) -> Union[str, list[int]]:
    return ALL if value == ALL else _whole_numbers(value, f"{name} must be a list of regions, counted from 0, or 'all'")


def _sign(value: object, name: str) -> int:
    if isinstance(value, bool) or value not in (1, -1):
        raise ValueError(f"{name} must be 1 or -1, not {value!r:.40}")
    return int(value)


def _bounds(value: object, name: str) -> list[float]:
    if not isinstance(value, (list, tuple)) or len(value) != 2:
        raise ValueError(f"{name} must be two numbers, the least and the largest K")
    return [_number(end, name) for end in value]


def _vertices_or(*words: str) -> Callable[[object, str], object]:
    def read(value: object, name: str) -> object:
        if isinstance(value, str) and value in words:
            return value
        if isinstance(value, str):
            raise ValueError(f"{name} must be a list of vertices, counted from 0, or {' or '.join(map(repr, words))}, not {value!r:.40}")
        return _vertices(value, name)

    return read


def _triple(value: object, name: str) -> list[float]:
    if not isinstance(value, (list, tuple)) or len(value) != 3:
        raise ValueError(f"{name} must be three numbers")
    return [_number(x, name) for x in value]


def _direction(value: object, name: str) -> list[float]:
    vector = _triple(value, name)
    unit(vector, name)
    return vector


def _points(value: object, name: str) -> list[list[float]]:
    if not isinstance(value, (list, tuple)):
        raise ValueError(f"{name} must be a list of [x, y, z]")
    return [_triple(point, name) for point in value]


def _plan(value: object, name: str) -> list[list[float]]:
    if not isinstance(value, (list, tuple)) or not all(isinstance(point, (list, tuple)) and len(point) in (2, 3) for point in value):
        raise ValueError(f"{name} must be a list of [x, y] or [x, y, z]")
    return [[_number(x, name) for x in point] for point in value]


def _where(value: object, name: str) -> object:
    if not isinstance(value, bool) and isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, (list, tuple)) and len(value) == 4 and all(isinstance(x, numbers.Real) for x in value):
        return [_number(x, name) for x in value]
    if isinstance(value, (list, tuple)) and all(isinstance(point, (list, tuple)) for point in value):
        return _plan(value, name)
    raise ValueError(f"{name} must be a region number, a box [x0, y0, x1, y1] or a closed polyline [[x, y], ...]")


def _triangles(value: object, name: str) -> list[list[int]]:
    if not isinstance(value, (list, tuple)):
        raise ValueError(f"{name} must be a list of triangles [a, b, c]")
    return [_vertices(face, name) for face in value]


def _truth(value: object, name: str) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"{name} must be true or false")
    return value


_READERS: dict[str, Callable[[object, str], object]] = {
    "vertices": _vertices,
    "point": _triple,
    "normal": _direction,
    "direction": _direction,
    "points": _points,
    "faces": _triangles,
    "regions": _regions,
    "sign": _sign,
    "bounds": _bounds,
    "ratio": _truth,
    "where": _where,
    "closed": _truth,
    **dict.fromkeys(("height", "weight", "rise", "volume", "level", "area", "length", "distance"), _number),
}
_OWN_READERS: dict[str, dict[str, Callable[[object, str], object]]] = {
    "height": {"vertices": _vertices_or(CROWN)},
    "level": {"vertices": _vertices_or(FREE_EDGES), "points": _plan},
    "edge in plan": {"vertices": _vertices_or(FREE_EDGES), "points": _plan},
    "within": {"vertices": _vertices_or(ALL), "points": _plan},
    **{kind: {"vertices": _vertices_or(ALL)} for kind in ("above", "below", "near plane")},
}
