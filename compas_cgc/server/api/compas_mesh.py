"""Decoding of COMPAS JSON, restricted to Mesh and CGCMesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import Unprocessable
from ..limits import Limits
from .decoding import polygons
from .decoding import vertex_array

if TYPE_CHECKING:
    from ...datastructures import CGCMesh

__all__ = ["check_compas_mesh", "read_compas_mesh"]

MESH_TYPE, CGC_MESH = "compas.datastructures/Mesh", "compas_cgc.datastructures/CGCMesh"


def read_compas_mesh(value: dict) -> CGCMesh:
    """Return the mesh in checked COMPAS JSON.

    Raises
    ------
    Unprocessable
        If COMPAS cannot read it.
    """
    from compas.datastructures import Mesh

    from ...datastructures import CGCMesh

    try:
        mesh = (CGCMesh if value["dtype"] == CGC_MESH else Mesh).__from_data__(value["data"])
        return mesh if isinstance(mesh, CGCMesh) else CGCMesh.from_mesh(mesh)
    except Exception:
        raise Unprocessable("'mesh' cannot be read as a COMPAS mesh; write it with compas.json_dumps") from None


def check_compas_mesh(value: object, limits: Limits) -> None:
    """Check COMPAS JSON before it is decoded.

    Raises
    ------
    Unprocessable, TooLarge
        If a field is missing, invalid or too large.
    """
    if not isinstance(value, dict) or value.get("dtype") not in (MESH_TYPE, CGC_MESH) or not isinstance(value.get("data"), dict):
        raise Unprocessable("'mesh' must be a COMPAS Mesh as JSON (compas.json_dumps), with 'dtype' and 'data'")
    data = value["data"]
    if _mentions_dtype(data):
        raise Unprocessable("'mesh' must hold numbers and strings only, no other COMPAS objects")
    if not isinstance(data.get("vertex"), dict) or not isinstance(data.get("face"), dict):
        raise Unprocessable("'mesh' must have the fields 'vertex' and 'face'")
    order = {str(key): i for i, key in enumerate(data["vertex"])}
    try:
        vertices = [[entry["x"], entry["y"], entry["z"]] for entry in data["vertex"].values()]
        corners = [[order[str(v)] for v in face] for face in data["face"].values()]
    except (KeyError, TypeError):
        raise Unprocessable("'mesh' must hold x, y and z of every vertex, and its faces must refer to existing vertices") from None
    polygons(corners, len(vertex_array(vertices, limits)), limits)


def _mentions_dtype(value: object) -> bool:
    if isinstance(value, dict):
        return "dtype" in value or any(_mentions_dtype(item) for item in value.values())
    return isinstance(value, list) and any(_mentions_dtype(item) for item in value if isinstance(item, (dict, list)))
