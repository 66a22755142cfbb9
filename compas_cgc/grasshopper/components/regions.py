"""Regions: the parts of a mesh as Rhino geometry."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple

import numpy as np

from ...io.rhino.rhinocommon import mesh_from_arrays
from ...io.rhino.rhinocommon import points_to_rhino
from ...io.rhino.rhinocommon import polyline_to_rhino
from ..runtime.component_feedback import add_warning
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message

__all__ = ["RegionsOutputs", "regions"]


class RegionsOutputs(NamedTuple):
    """Outputs of the component."""

    regions: Any
    creases: Any
    edges: Any
    supports: Any
    targets: Any


@reports_errors(RegionsOutputs)
def regions(component: Any, cgc_mesh: Any) -> RegionsOutputs:
    """Take a mesh apart into regions, creases, open edges and supports."""
    if cgc_mesh is None:
        add_warning(component, "connect a CGC mesh")
        return RegionsOutputs(*[None] * len(RegionsOutputs._fields))
    parts = []
    for faces in cgc_mesh.regions():
        corners = [cgc_mesh.face_vertices(face) for face in faces]
        keys = sorted({v for face in corners for v in face})
        place = {key: i for i, key in enumerate(keys)}
        parts.append(mesh_from_arrays(_points(cgc_mesh, keys), np.array([[place[v] for v in face] for face in corners])))
    set_message(component, f"{len(parts)} regions")
    return RegionsOutputs(
        parts,
        [polyline_to_rhino(_points(cgc_mesh, path)) for path in cgc_mesh.creases()],
        [polyline_to_rhino(_points(cgc_mesh, [*loop, loop[0]])) for loop in cgc_mesh.boundary_loops()],
        points_to_rhino(_points(cgc_mesh, cgc_mesh.supports())),
        [cgc_mesh.region_target(number) for number in range(len(parts))],
    )


def _points(mesh: Any, keys: list) -> np.ndarray:
    return np.array([mesh.vertex_coordinates(key) for key in keys], dtype=np.float64).reshape(-1, 3)
