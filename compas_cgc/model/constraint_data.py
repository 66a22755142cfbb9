"""Serialization of constraints: the plain data that files, meshes and requests hold."""

from __future__ import annotations

import math
import numbers
from collections.abc import Mapping
from dataclasses import fields
from typing import Any
from typing import Callable

import numpy as np

from .constraints import AtHeight
from .constraints import Constraint
from .constraints import Fixed
from .constraints import Mirror
from .constraints import OnCurve
from .constraints import OnLine
from .constraints import OnPlane
from .constraints import Proximity
from .constraints import unit

__all__ = ["KINDS", "as_constraints", "constraint_data", "constraint_of"]

KINDS = {"plane": OnPlane, "height": AtHeight, "line": OnLine, "curve": OnCurve, "held": Fixed, "near": Proximity, "mirror": Mirror}


def constraint_data(constraint: Constraint) -> dict[str, Any]:
    """Return a constraint as ``{"kind": ..., ...}`` of plain lists and numbers, its fields by name."""
    kind = next(name for name, own in KINDS.items() if type(constraint) is own)
    values = {field.name: getattr(constraint, field.name) for field in fields(constraint)}
    return {"kind": kind, **{name: value if isinstance(value, bool) else np.asarray(value).tolist() for name, value in values.items()}}


def constraint_of(data: Mapping[str, Any]) -> Constraint:
    """Return the constraint of plain data.

    Raises
    ------
    ValueError
        If there is no such kind, or a field is missing, unknown or of the wrong type.
    """
    kind = data.get("kind") if isinstance(data, Mapping) else None
    if not isinstance(kind, str) or kind not in KINDS:
        raise ValueError(f"a constraint must be an object with a 'kind': {', '.join(KINDS)}")
    known = {field.name: field for field in fields(KINDS[kind])}
    values = {name: value for name, value in data.items() if name != "kind"}
    unknown = [name for name in values if name not in known]
    if unknown:
        raise ValueError(f"a constraint of kind {kind} has no {unknown[0]!r:.40}; it has {', '.join(known)}")
    try:
        return KINDS[kind](**{name: _READERS[name](value, name) for name, value in values.items()})
    except TypeError:
        needed = ", ".join(known)
        raise ValueError(f"a constraint of kind {kind} lacks a field; it has {needed}") from None


def as_constraints(given: object) -> tuple[Constraint, ...]:
    """Return constraints of which some may be plain data; one alone counts as a list of one.

    Raises
    ------
    ValueError
        If something is no constraint.
    """
    items = [given] if isinstance(given, (Constraint, Mapping)) else list(given or ())  # type: ignore[call-overload]
    return tuple(item if isinstance(item, Constraint) else constraint_of(item) for item in items)


def _number(value: object, name: str) -> float:
    if isinstance(value, bool) or not isinstance(value, numbers.Real) or not math.isfinite(value):
        raise ValueError(f"{name} of a constraint must be a finite number")
    return float(value)


def _vertices(value: object, name: str) -> list[int]:
    if not isinstance(value, (list, tuple)) or not all(isinstance(v, numbers.Integral) and not isinstance(v, bool) for v in value):
        raise ValueError("vertices of a constraint must be a list of vertices, counted from 0")
    return [int(v) for v in value]


def _triple(value: object, name: str) -> list[float]:
    if not isinstance(value, (list, tuple)) or len(value) != 3:
        raise ValueError(f"{name} of a constraint must be three numbers")
    return [_number(x, name) for x in value]


def _direction(value: object, name: str) -> list[float]:
    vector = _triple(value, name)
    unit(vector, f"{name} of a constraint")
    return vector


def _points(value: object, name: str) -> list[list[float]]:
    if not isinstance(value, (list, tuple)):
        raise ValueError("points of a constraint must be a list of [x, y, z]")
    return [_triple(point, name) for point in value]


def _truth(value: object, name: str) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"{name} of a constraint must be true or false")
    return value


_READERS: dict[str, Callable[[object, str], object]] = {
    "vertices": _vertices,
    "point": _triple,
    "normal": _direction,
    "direction": _direction,
    "points": _points,
    "height": _number,
    "weight": _number,
    "closed": _truth,
}
