"""Decoding of Rhino geometry, after a check of headers and limits."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...discrete.arrays import FloatArray
from ...io.rhino.curves import curve_points
from ...io.rhino.meshes import mesh_to_arrays
from ...io.rhino.precision import rounding_of
from ...io.rhino.sketch import Part
from ..api.decoding import LARGEST
from ..errors import TooLarge
from ..errors import Unprocessable
from ..limits import Limits
from .opennurbs_header import CURVES
from .opennurbs_header import read_head

__all__ = ["read_curve", "read_mesh"]


def read_mesh(data: dict, name: str, limits: Limits) -> Part:
    """Return the mesh of an input.

    Raises
    ------
    Unprocessable, TooLarge
        If the mesh is damaged, of another type or too large.
    """
    head = read_head(data.get("data"))
    # Checked before decoding: a few damaged bytes can declare billions of faces.
    if head is not None and not (0 <= head.vertices <= limits.vertices and 0 <= head.faces <= limits.faces):
        raise TooLarge(
            f"input '{name}' has {head.vertices} vertices and {head.faces} faces; "
            f"the server accepts at most {limits.vertices} vertices and {limits.faces} faces; use a coarser mesh"
        )
    geometry = _decode(data, name, "mesh", ("Mesh",), "convert it with Mesh or QuadRemesh")
    if not len(geometry.Vertices) or not len(geometry.Faces):
        raise Unprocessable(f"input '{name}' is a mesh without vertices or faces, or its data are damaged; create the mesh again")
    vertices, faces = mesh_to_arrays(geometry)
    if not (np.abs(vertices) <= LARGEST).all():
        raise Unprocessable(f"input '{name}' has vertices with coordinates that are not finite; create the mesh again")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise Unprocessable(f"input '{name}' has faces with vertices that do not exist; create the mesh again")
    rounding = rounding_of(vertices, geometry.Vertices.UseDoublePrecisionVertices)
    return Part(f"input '{name}'", vertices, faces, rounding, None, {})


def read_curve(data: dict, name: str, tolerance: float) -> FloatArray:
    """Return points (k, 3) along a curve, whose polyline is within the tolerance [L]."""
    own = {str(key).lower(): value for key, value in data.items()}
    if "from" in own and "to" in own:
        points = _ends(own, name)
    else:
        geometry = _decode(data, name, "curve", CURVES, "connect curves to it")
        points = curve_points(geometry, tolerance)
    if not len(points) or not (np.abs(points) <= LARGEST).all():
        raise Unprocessable(f"input '{name}' holds a curve without finite points; draw it again")
    return points


def _decode(data: dict, name: str, kind: str, classes: tuple[str, ...], hint: str) -> Any:
    """Return geometry of one of the given classes; others are not decoded, as damaged data can take minutes."""
    import rhino3dm

    head = read_head(data.get("data"))
    if head is not None and head.name not in classes:
        raise Unprocessable(f"input '{name}' is {'an' if head.name[0] in 'AEo' else 'a'} {head.name}, not a {kind}; {hint}")
    geometry: Any = None
    if head is not None:
        try:
            # Some clients send numbers as strings.
            numbers = {key: int(data[key]) for key in ("version", "archive3dm", "opennurbs")}
            geometry = rhino3dm.CommonObject.Decode({**numbers, "data": data["data"]})
        except Exception:
            geometry = None
    if type(geometry).__name__ not in classes:
        raise Unprocessable(f"input '{name}' cannot be decoded; connect a {kind} to it")
    return geometry


def _ends(own: dict, name: str) -> FloatArray:
    try:
        ends = [{str(key).lower(): value for key, value in own[end].items()} for end in ("from", "to")]
        return np.array([[float(end[axis]) for axis in "xyz"] for end in ends])
    except (AttributeError, KeyError, TypeError, ValueError):
        raise Unprocessable(f"input '{name}' holds a line without end points") from None
