"""Write a mesh with its roles and targets as a .3dm file that is read as the same problem."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING
from typing import Optional
from typing import Union

import numpy as np
import rhino3dm

from ..._version import __version__
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ..asked import Asked
from ..asked import asked_of
from .archive import write_archive
from .drawing import Drawing
from .meshes import mesh_from_arrays
from .problem_text import vertex_text
from .units import unit_system

if TYPE_CHECKING:
    from ...datastructures import CGCMesh

__all__ = ["draw_roles", "new_archive", "write_model"]


def write_model(path: Union[str, os.PathLike], mesh: CGCMesh, version: int = 7, units: Optional[str] = None) -> None:
    """Write a mesh on the layers of the convention: mesh, supports, creases, and a dot with the target in each region.

    Every bit of the coordinates and targets comes back when the file is read. The dummy
    mesh is left out.

    Parameters
    ----------
    path
        The .3dm file; an older one is replaced when the new one is complete.
    mesh
        Mesh with roles and targets.
    version
        7 (opens in Rhino 7 and later) or 8.
    units
        Unit system such as ``"Millimeters"``. Default: that of the mesh's attributes, or metres.

    Raises
    ------
    FileError
        If it cannot be written.
    """
    asked = asked_of(mesh)
    drawing = Drawing(new_archive(asked.vertices, units or mesh.attributes.get("units"), mesh.attributes.get("tolerance")))
    on_mesh = drawing.layer("CGC::Mesh", (120, 120, 120))
    drawing.mesh(mesh_from_arrays(asked.vertices, asked.faces), drawing.attributes(on_mesh, asked.name, vertex_text(asked)))
    draw_roles(drawing, asked, "CGC")
    on_targets = drawing.layer("CGC::Targets", (30, 130, 60))
    for region, K in enumerate(asked.region_targets()):
        if K is not None:
            place = _inside(asked.vertices, asked.faces[asked.regions == region])
            drawing.dot(f"K={K!r}", place, drawing.attributes(on_targets, f"region {region}"))
    _draw_constraints(drawing, asked.vertices, mesh.attributes.get("constraints") or [])
    write_archive(drawing.archive, path, version)


def _draw_constraints(drawing: Drawing, vertices: FloatArray, constraints: list[dict]) -> None:
    """Draw constraints as they are read: curves, kept curves, points at a height."""
    layer = drawing.layer("CGC::Constraints", (120, 40, 140)) if constraints else -1
    for item in constraints:
        own = vertices[item["vertices"]]
        if item["kind"] == "curve":
            points = np.array(item["points"])
            drawing.polyline(np.concatenate([points, points[:1]]) if item["closed"] else points, drawing.attributes(layer))
        elif item["kind"] == "held":
            drawing.points(own, drawing.attributes(layer, text={"keep": "yes"}))
        else:
            drawing.points(np.column_stack([own[:, :2], np.full(len(own), item["height"])]), drawing.attributes(layer))


def new_archive(vertices: FloatArray, units: Optional[str], tolerance: Optional[float]) -> rhino3dm.File3dm:
    """Return an empty archive for a mesh with vertices (n, 3) [L], by default in metres with a tolerance to suit its size."""
    archive = rhino3dm.File3dm()
    archive.ApplicationName = "compas_cgc"
    archive.ApplicationDetails = f"compas_cgc {__version__}"
    archive.Settings.ModelUnitSystem = unit_system(units or "Meters")
    archive.Settings.ModelAbsoluteTolerance = tolerance or _tolerance(vertices)
    return archive


def draw_roles(drawing: Drawing, asked: Asked, parent: str) -> None:
    """Draw the supports as points and the creases as polylines on the sublayers of `parent`."""
    on_supports = drawing.layer(f"{parent}::Supports", (200, 30, 30))
    drawing.points(asked.vertices[asked.supports], drawing.attributes(on_supports))
    on_creases = drawing.layer(f"{parent}::Creases", (20, 60, 160))
    for path in asked.creases:
        drawing.polyline(asked.vertices[path], drawing.attributes(on_creases))


def _tolerance(vertices: FloatArray) -> float:
    """Return a ten-thousandth of the size, rounded down to a power of ten, at most 0.001 [L]."""
    size = float(np.linalg.norm(np.ptp(vertices, axis=0))) if len(vertices) else 0.0
    return min(1e-3, 10.0 ** math.floor(math.log10(1e-4 * size))) if size > 0 else 1e-3


def _inside(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the centre of the face nearest to the middle of a region (3,) [L]."""
    centres = vertices[faces].mean(axis=1)
    return centres[np.argmin(np.linalg.norm(centres - centres.mean(axis=0), axis=1))]
