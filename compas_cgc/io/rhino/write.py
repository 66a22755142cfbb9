"""Write a problem as a .3dm file that is read as the same problem."""

from __future__ import annotations

import math
import os
from typing import Optional
from typing import Union

import numpy as np
import rhino3dm

from ..._version import __version__
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...model.constraint_data import constraint_data
from ...model.constraints import Constraint
from ...model.problem import CGCProblem
from ...model.problem import PosesProblem
from .archive import write_archive
from .layer_writer import LayerWriter
from .meshes import mesh_from_arrays
from .sketch import Drawn
from .snapping import as_drawn
from .snapping import find_constraints
from .snapping import snap_distance
from .units import unit_system
from .user_text import constraint_text
from .user_text import vertex_text

__all__ = ["draw_problem", "new_archive", "write_problem"]


def write_problem(path: Union[str, os.PathLike], problem: PosesProblem, version: int = 7) -> None:
    """Write a problem on the layers of the convention: mesh, supports, creases, constraints, and a dot with the target of each region.

    Every bit of the coordinates and targets comes back when the file is read. The dummy
    mesh is left out.

    Parameters
    ----------
    path
        The .3dm file; an older one is replaced when the new one is complete.
    problem
        A problem or mesh, drawn in its units, by default metres.
    version
        7 (opens in Rhino 7 and later) or 8.

    Raises
    ------
    FileError
        If it cannot be written.
    """
    own = problem.to_problem().without_dummies()
    writer = LayerWriter(new_archive(own))
    draw_problem(writer, own, "CGC", mesh_from_arrays(own.vertices, own.faces))
    on_targets = writer.layer("CGC::Targets", (30, 130, 60))
    label = own.regions()
    for region, K in enumerate(own.region_targets()):
        if K is not None:
            place = _inside(own.vertices, own.faces[label == region])
            writer.dot(f"K={K!r}", place, writer.attributes(on_targets, f"region {region}"))
    write_archive(writer.archive, path, version)


def new_archive(problem: CGCProblem) -> rhino3dm.File3dm:
    """Return an empty archive for a problem, by default in metres with a tolerance to suit its size."""
    archive = rhino3dm.File3dm()
    archive.ApplicationName = "compas_cgc"
    archive.ApplicationDetails = f"compas_cgc {__version__}"
    archive.Settings.ModelUnitSystem = unit_system(problem.drawing.units or "Meters")
    archive.Settings.ModelAbsoluteTolerance = problem.drawing.tolerance or _tolerance(problem.vertices)
    return archive


def draw_problem(writer: LayerWriter, problem: CGCProblem, parent: str, mesh: rhino3dm.Mesh, text: Optional[dict[str, str]] = None) -> None:
    """Draw a mesh with its supports as points, creases as polylines and constraints on the sublayers of `parent`.

    The user text of the mesh is `text` with what of the problem cannot be drawn.
    """
    drawn, others = _drawable(problem, float(writer.archive.Settings.ModelAbsoluteTolerance))
    texts = {**(text or {}), **vertex_text(problem), **constraint_text(others, len(problem.vertices))}
    on_mesh = writer.layer(f"{parent}::Mesh", (120, 120, 120))
    writer.mesh(mesh, writer.attributes(on_mesh, problem.drawing.name, texts))
    on_supports = writer.layer(f"{parent}::Supports", (200, 30, 30))
    writer.points(problem.vertices[problem.supports], writer.attributes(on_supports))
    on_creases = writer.layer(f"{parent}::Creases", (20, 60, 160))
    for path in problem.crease_paths():
        writer.polyline(problem.vertices[path], writer.attributes(on_creases))
    on_constraints = writer.layer(f"{parent}::Constraints", (120, 40, 140)) if drawn else -1
    for item in drawn:
        draw = writer.polyline if item.kind == "curve" else writer.cloud
        draw(item.points, writer.attributes(on_constraints, text=item.text))


def _drawable(problem: CGCProblem, tolerance: float) -> tuple[list[Drawn], list[Constraint]]:
    """Return constraints as they are drawn, and those that would not be found again as they are."""
    V = problem.vertices
    snap = snap_distance(V, problem.faces, tolerance) if problem.constraints else 0.0
    drawn, others = [], []
    for constraint in problem.constraints:
        item = as_drawn(constraint, V)
        found = [] if item is None else find_constraints([item], V, snap, "")[0]
        if item is not None and [_plain(constraint)] == [_plain(other) for other in found]:
            drawn.append(item)
        else:
            others.append(constraint)
    return drawn, others


def _plain(constraint: Constraint) -> dict:
    data = constraint_data(constraint)
    return {**data, "vertices": sorted(set(data["vertices"]))}


def _tolerance(vertices: FloatArray) -> float:
    """Return a ten-thousandth of the size, rounded down to a power of ten, at most 0.001 [L]."""
    size = float(np.linalg.norm(np.ptp(vertices, axis=0))) if len(vertices) else 0.0
    return min(1e-3, 10.0 ** math.floor(math.log10(1e-4 * size))) if size > 0 else 1e-3


def _inside(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the centre of the face nearest to the middle of a region (3,) [L]."""
    centres = vertices[faces].mean(axis=1)
    return centres[np.argmin(np.linalg.norm(centres - centres.mean(axis=0), axis=1))]
