"""Write a mesh with its roles and targets as a .3dm file that is read as the same problem."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING
from typing import Optional
from typing import Union

import numpy as np
import rhino3dm

from .._version import __version__
from ..files.asked import region_faces
from ..files.asked import region_targets
from .archive import write_archive
from .drawing import Drawing
from .meshes import mesh_from_arrays
from .problem_text import crease_polylines
from .problem_text import vertex_text
from .units import unit_system

if TYPE_CHECKING:
    from ..datastructures import CGCMesh

__all__ = ["new_archive", "write_model"]


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
    vertices, faces = mesh.arrays()
    drawing = Drawing(new_archive(mesh, units))
    on_mesh = drawing.layer("CGC::Mesh", (120, 120, 120))
    text = vertex_text(mesh)
    drawing.mesh(mesh_from_arrays(vertices, faces), drawing.attributes(on_mesh, mesh.name, text))
    draw_roles(drawing, mesh, "CGC")
    on_targets = drawing.layer("CGC::Targets", (30, 130, 60))
    labels = region_faces(mesh)
    for region, K in enumerate(region_targets(mesh)):
        if K is not None:
            drawing.dot(f"K={K!r}", _inside(vertices, faces[labels == region]), drawing.attributes(on_targets, f"region {region}"))
    write_archive(drawing.archive, path, version)


def new_archive(mesh: CGCMesh, units: Optional[str] = None) -> rhino3dm.File3dm:
    """Return an empty archive in the units and tolerance of a mesh."""
    archive = rhino3dm.File3dm()
    archive.ApplicationName = "compas_cgc"
    archive.ApplicationDetails = f"compas_cgc {__version__}"
    archive.Settings.ModelUnitSystem = unit_system(units or mesh.attributes.get("units") or "Meters")
    archive.Settings.ModelAbsoluteTolerance = mesh.attributes.get("tolerance") or _tolerance(mesh)
    return archive


def draw_roles(drawing: Drawing, mesh: CGCMesh, parent: str) -> None:
    """Draw the supports as points and the creases as polylines on the sublayers of `parent`."""
    keys = mesh.supports()
    places = np.array([mesh.vertex_coordinates(key) for key in keys]).reshape(-1, 3)
    drawing.points(places, drawing.attributes(drawing.layer(f"{parent}::Supports", (200, 30, 30))))
    on_creases = drawing.layer(f"{parent}::Creases", (20, 60, 160))
    for line in crease_polylines(mesh):
        drawing.polyline(line, drawing.attributes(on_creases))


def _tolerance(mesh: CGCMesh) -> float:
    """Return a ten-thousandth of the size, rounded down to a power of ten, at most 0.001 [L]."""
    vertices, _ = mesh.arrays()
    size = float(np.linalg.norm(np.ptp(vertices, axis=0))) if len(vertices) else 1.0
    return min(1e-3, 10.0 ** math.floor(math.log10(1e-4 * size))) if size > 0 else 1e-3


def _inside(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Return the centre of the face nearest to the middle of a region (3,) [L]."""
    centres = vertices[faces].mean(axis=1)
    return centres[np.argmin(np.linalg.norm(centres - centres.mean(axis=0), axis=1))]
