"""Validation of arguments of the wrong kind, with messages that say what to write instead."""

from __future__ import annotations

import numbers
import os
from collections.abc import Iterable
from collections.abc import Mapping
from collections.abc import Sequence
from typing import Any
from typing import Optional
from typing import Union

import numpy as np

from ..errors import CGCError
from ..meshing.boundary import SUPPORT_NAMES
from ..meshing.checks import listed

__all__ = [
    "checked_number",
    "plan_direction",
    "refuse_other_units",
    "no_region",
    "no_vertex",
    "vertex_names",
    "vertex_paths",
    "wrong_problem",
]

# length over the size of the surface above which it is probably in other units; 1,000 for mm and m, 39 for inches and m
MAX_LENGTH_RATIO = 20.0
NEAREST = "mesh.vertices_near(points) returns the keys of the vertices nearest to given points"


def checked_number(value: object, name: str) -> float:
    """Return a number as a float.

    Raises
    ------
    ValueError
        If it is not a real number.
    """
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise ValueError(f"{name} must be a number, not {_shown(value)}")
    return float(value)


def plan_direction(value: object, name: str) -> tuple[float, float]:
    """Return a direction in plan as two floats.

    Raises
    ------
    ValueError
        If it is not two finite numbers that are not both zero.
    """
    pair = tuple(checked_number(own, name) for own in value) if isinstance(value, Sequence) and not isinstance(value, str) else ()
    if len(pair) != 2 or not (np.isfinite(pair).all() and any(pair)):
        raise ValueError(f"{name} must be two numbers that are not both zero, such as (0, 1), not {_shown(value)}")
    return pair


def refuse_other_units(name: str, value: float, size: float, units: Optional[str]) -> None:
    """Refuse a length that is far larger than the surface.

    Parameters
    ----------
    name
        Name of the length, such as ``the size of panels``.
    value, size
        The length and the size of the surface [L].
    units
        Units of the drawing, None if unknown.

    Raises
    ------
    CGCError
        With the size of the surface.
    """
    if value > MAX_LENGTH_RATIO * size:
        unit = (units or "units of the model").lower()
        raise CGCError(f"{name}, {value:g} {unit}, is far larger than the surface, whose size is {size:.3g} {unit}; give it in {unit}")


def no_region(region: object, count: int, creased: bool) -> str:
    """Return the error message for a region that does not exist."""
    number = isinstance(region, numbers.Integral) and not isinstance(region, bool)
    if not number:
        return f"a region must be given by its number, not {_shown(region)}; {_numbered(count)}"
    one = creased and count == 1
    why = "; its creases separate no regions: they must run from boundary to boundary, or close" if one else ""
    return f"there is no region {region}; {_numbered(count)}{why}"


def no_vertex(lost: Sequence[object], keys: Iterable[int]) -> str:
    """Return the error message for vertices that do not exist, with the range of those that do."""
    known = sorted(keys)
    those = f"; its vertices are numbered from {known[0]} to {known[-1]}" if known else "; it has none"
    return f"there {'is no vertex' if len(lost) == 1 else 'are no vertices'} {listed(lost)} in the mesh{those}"


def _numbered(count: int) -> str:
    return f"the mesh has regions 0 to {count - 1}" if count > 1 else "the mesh has 1 region, number 0"


def vertex_names(given: Any, what: str) -> list[int]:
    """Return vertex keys as integers.

    Parameters
    ----------
    given
        Vertex keys.
    what
        Name of the argument in error messages, such as ``"supports"``.

    Raises
    ------
    ValueError
        If they are coordinates, words, or a single vertex without a list.
    """
    if isinstance(given, numbers.Number):
        raise ValueError(f"{what} must be a list of vertices, not the number {given}; write [{given}]")
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise ValueError(f"{what} must be a list of vertices, not {_shown(given)}")
    items = list(given)
    if len(items) in (2, 3) and len(set(map(repr, items))) < len(items) and all(isinstance(item, float) for item in items):
        raise ValueError(f"{what} must be keys of vertices, not coordinates such as {_shown(tuple(items))}; {NEAREST}")
    return [_vertex(item, what) for item in items]


def vertex_paths(given: Any) -> list[list[int]]:
    """Return creases as paths of vertex keys.

    Raises
    ------
    ValueError
        If they are coordinates, or a single path without a list around it.
    """
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise ValueError(f"creases must be a list of paths of vertices such as [[0, 1, 2]], not {_shown(given)}")
    items = list(given)
    if items and all(isinstance(item, numbers.Number) for item in items):
        raise ValueError(f"creases must be a list of paths, not one path of vertices; write [{_shown(items)}]")
    paths = [vertex_names(item, "the vertices of a crease") for item in items]
    short = next((path for path in paths if len(path) < 2), None)
    if short is not None:
        raise ValueError(f"a crease must have two or more vertices, not {short}; give the whole path")
    return paths


def wrong_problem(given: object, use: str = "is solved") -> str:
    """Return the error message for an object that is neither a problem nor a mesh with roles.

    `use` says what a problem would be used for.
    """
    if hasattr(given, "halfedge") and hasattr(given, "vertices"):
        return "a COMPAS mesh has no supports and targets; convert it with CGCMesh.from_mesh(mesh) and set them"
    if isinstance(given, (str, os.PathLike)):
        return f"read the file first: compas_cgc.read({str(given)!r})"
    if isinstance(given, (np.ndarray, Sequence, Mapping)):
        return "convert vertices and faces first: CGCProblem(vertices, faces) or CGCMesh.from_vertices_and_faces(vertices, faces)"
    if isinstance(given, type):
        return f"{given.__name__} is a class; create an instance first, such as CGCMesh.from_outline(points, edge_length)"
    return f"a CGCMesh or a CGCProblem {use}, not {_shown(given)}"


def _vertex(item: Any, what: str) -> int:
    if isinstance(item, (bool, np.bool_)):
        raise ValueError(f"{what} must be keys of vertices, not a mask; use np.flatnonzero(mask)")
    if isinstance(item, numbers.Real):
        if float(item).is_integer():
            return int(float(item))
        raise ValueError(f"{what} must be whole numbers, the keys of vertices, not {item}")
    if isinstance(item, str):
        if item in SUPPORT_NAMES:
            raise ValueError(f"write {item!r} without list brackets")
        raise ValueError(f"{what} must be whole numbers, the keys of vertices, not {item!r}")
    if isinstance(item, Iterable):
        raise ValueError(f"{what} must be keys of vertices, not coordinates such as {_shown(item)}; {NEAREST}")
    raise ValueError(f"{what} must be whole numbers, the keys of vertices, not {_shown(item)}")


def _shown(value: Any) -> str:
    text: Union[str, Any] = repr(value.tolist() if isinstance(value, np.ndarray) else value)
    return text if len(text) <= 60 else text[:57] + "..."
