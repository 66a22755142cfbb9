"""Wires: accepted types of each component input, and errors for other types."""

from __future__ import annotations

import math
import numbers
from collections.abc import Callable
from collections.abc import Mapping
from collections.abc import Sequence
from typing import Any
from typing import NamedTuple

from ...datastructures import CGCMesh
from ...datastructures import SolveResult
from ...errors import CGCError
from ...model.constraints import Constraint
from ...model.problem import CGCProblem
from ...solvers import Settings
from .address import Address
from .wire_mesh import WireMesh

__all__ = ["LISTS", "check_wires", "is_tree", "single"]

# Inputs that take lists; the others take a single value.
LISTS = frozenset(
    (
        "K",
        "clear",
        "clearance",
        "costs",
        "creases",
        "curves",
        "goals",
        "law",
        "moulds",
        "others",
        "point",
        "points",
        "radius",
        "region",
        "seams",
        "supports",
        "surfaces",
        "weights",
    )
    + ("through", "unknown")
)


MESHES = (WireMesh, CGCMesh, CGCProblem)  # scripts on the canvas may put out the last two


class Wire(NamedTuple):
    """Accepted type of an input."""

    fits: Callable[[Any], bool]  # whether a value is accepted
    wanted: str  # description of what to connect


def _is_number(value: Any) -> bool:
    return isinstance(value, numbers.Real) and not isinstance(value, bool)


def _is_whole(value: Any) -> bool:
    return _is_number(value) and float(value).is_integer()


def _is_switch(value: Any) -> bool:
    return isinstance(value, bool) or (_is_number(value) and value in (0, 1))


def _is_geometry(value: Any) -> bool:
    """Check whether a value may be Rhino geometry, which has too many classes to list."""
    return not isinstance(value, (str, bytes, numbers.Number, *MESHES, SolveResult, Settings, Constraint, Address))


def _is_mesh(value: Any) -> bool:
    # Unlike meshes, Breps and SubDs also have edges.
    return _is_geometry(value) and hasattr(value, "Vertices") and hasattr(value, "Faces") and not hasattr(value, "Edges")


def _is_point(value: Any) -> bool:
    return _is_geometry(value) and hasattr(value, "X") and hasattr(value, "Z")


def _is_place(value: Any) -> bool:
    return _is_point(value) and all(math.isfinite(getattr(value, axis, 0.0)) for axis in "XYZ")


def _is_curve(value: Any) -> bool:
    return _is_geometry(value) and hasattr(value, "TryGetPolyline")


def _is_surface(value: Any) -> bool:
    """Check for surfaces, Breps, extrusions, SubDs and curves; meshes have a separate input."""
    return _is_geometry(value) and not _is_mesh(value) and any(hasattr(value, name) for name in ("Faces", "NormalAt", "TryGetPolyline"))


def _is_plane(value: Any) -> bool:
    return _is_geometry(value) and hasattr(value, "Origin") and hasattr(value, "ZAxis")


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


_SWITCH = Wire(_is_switch, "a toggle, True or False")
_TEXT = Wire(_is_text, "a text, from a panel or a value list")
_NUMBER = Wire(_is_number, "a number")

_AMOUNTS = (
    *("allowance", "area", "aside", "below", "clearance", "crease_stiffness", "depth", "edge_length", "filter_radius", "height", "kerf"),
    *("length", "limit", "margin", "nearness", "panel", "pressure", "rise", "s", "size", "smoothness", "spacing", "strain", "thickness"),
    *("tolerance", "volume", "weight", "width"),
)

# Types by name of the input, which is the same for all components.
WIRES = {
    "cgc_mesh": Wire(lambda value: isinstance(value, MESHES), "the output cgc_mesh of CGC Mesh, Target, Solve or Example"),
    "settings": Wire(lambda value: isinstance(value, Settings), "the output of Settings"),
    "goals": Wire(lambda value: isinstance(value, (Constraint, Mapping)), "the output of Goals or Constraints"),
    "others": Wire(lambda value: isinstance(value, (Constraint, Mapping)), "the output of another Constraints"),
    "server": Wire(lambda value: isinstance(value, (Address, str)), "the output of Server, or its address as a text"),
    "result": Wire(lambda value: isinstance(value, SolveResult), "the output result of Solve"),
    "mesh": Wire(_is_mesh, "a mesh; surfaces and outlines go to the input surfaces"),
    "K": Wire(_is_number, "numbers, in 1 / (model unit)²"),
    "law": Wire(_is_text, "texts such as H = 0.1, from a panel"),
    "radius": Wire(_is_number, "radii, in model units"),
    "region": Wire(_is_whole, "numbers of regions, counted from 0"),
    "point": Wire(_is_place, "points whose coordinates are numbers"),
    "points": Wire(_is_point, "points"),
    "supports": Wire(_is_point, "points"),
    "creases": Wire(_is_curve, "curves"),
    "surfaces": Wire(_is_surface, "surfaces, Breps or SubDs, or closed curves; a mesh goes to the input mesh"),
    "design": Wire(lambda value: _is_mesh(value) or isinstance(value, (*MESHES, str)), "a mesh, a CGC mesh, or the path of a file"),
    "moulds": Wire(_is_number, "a number of moulds, or radii in model units"),
    "costs": Wire(_is_number, "six numbers, from 0 up"),
    "weights": Wire(_is_number, "numbers, five for each place"),
    "seams": Wire(_is_curve, "curves"),
    "curve": Wire(_is_curve, "a curve"),
    "plane": Wire(_is_plane, "a plane"),
    "mirror": Wire(_is_plane, "a plane"),
    "clear": Wire(_is_curve, "closed curves"),
    "curves": Wire(_is_curve, "curves"),
    "within": Wire(_is_curve, "a closed curve"),
    "through": Wire(_is_point, "points"),
    "unknown": Wire(_is_whole, "numbers of regions, counted from 0"),
    **dict.fromkeys(_AMOUNTS, _NUMBER),
    **dict.fromkeys(("count", "delay", "number", "steps"), Wire(_is_whole, "a whole number")),
    **dict.fromkeys(
        (
            "bake",
            "flip",
            "keep_edges",
            "least_bending",
            "level_edges",
            "per_sheet",
            "reset",
            "rough",
            "run",
            "split",
            "wait",
            "whole",
            "write",
        ),
        _SWITCH,
    ),
    **dict.fromkeys(
        ("along", "column", "fix", "key", "kind", "layer", "material", "measure", "method", "path", "python", "show", "url", "variant"),
        _TEXT,
    ),
}


def is_tree(value: Any) -> bool:
    """Check whether a value is a data tree. The type is asked, as the COMPAS mesh of a :class:`WireMesh` has a cost."""
    return all(hasattr(type(value), name) for name in ("Paths", "Branch", "AllData"))


def single(name: str, value: Any) -> Any:
    """Return the value of a single-value input, which arrives as a list if the input is set to list access.

    Parameters
    ----------
    name
        Name of the input.
    value
        The input: a value, or a list of at most one value that is not null.

    Raises
    ------
    CGCError
        If the list has several values.
    """
    if name in LISTS or value is None:
        return value
    values = _values(value)
    there = [one for one in values if one is not None]
    if len(there) > 1:
        raise CGCError(f"the input {name} received {len(there)} values; connect one value, or set the input to item access")
    return there[0] if there else None


def check_wires(inputs: Mapping[str, Any]) -> None:
    """Raise an error for the first input with a value of the wrong type.

    Parameters
    ----------
    inputs
        Values or lists of values by name of the input, None if nothing is connected.
    """
    for name, value in inputs.items():
        wire = WIRES.get(name)
        if wire is None or value is None:
            continue
        for one in _values(value):
            inner = getattr(one, "Value", one) if type(one).__name__.startswith("GH_") else one
            if inner is not None and not wire.fits(inner):
                raise CGCError(f"the input {name} received {_kind(inner)}; connect {wire.wanted}")


def _values(value: Any) -> Sequence[Any]:
    """Return the values of a list or data tree; a single value becomes a list. Points can be rows of numbers."""
    if is_tree(value):
        return list(value.AllData())
    is_list = type(value) is list or type(value).__name__.startswith("List") or (type(value) is tuple and not all(map(_is_number, value)))
    return list(value) if is_list else [value]


def _kind(value: Any) -> str:
    """Return the name of a value's type in the terms of Grasshopper users."""
    if isinstance(value, str):
        return f"the text {value[:30]!r}"
    if isinstance(value, bool):
        return f"the value {value}"
    if isinstance(value, numbers.Number):
        return f"the number {value}"
    name = {"CGCMesh": "CGC mesh", "WireMesh": "CGC mesh", "CGCProblem": "CGC mesh", "SolveResult": "result of Solve"}.get(
        type(value).__name__, type(value).__name__
    )
    return f"{'an' if name[0] in 'AEIOaeio' else 'a'} {name}"
