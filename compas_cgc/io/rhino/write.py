"""Writing of objects and problems to layers of a .3dm file."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable
from collections.abc import Mapping
from collections.abc import Sequence
from typing import Optional
from typing import Union

import numpy as np

from ..._version import __version__
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.plan import flattened
from ...errors import names_what_was_meant
from ...model.constraint_data import constraint_data
from ...model.constraints import Constraint
from ...model.goals.inequalities import Clearance
from ...model.goals.inequalities import Within
from ...model.goals.numbers import in_plan
from ...model.goals.wholes import Length
from ...model.laws import ConstantCurvature
from ...model.problem import CGCProblem
from ...model.problem import PosesProblem
from ._types import Archive
from ._types import Mesh
from ._types import ObjectAttributes
from .archive import rhino3dm_module
from .archive import write_archive
from .goals import drawn_goal
from .goals import find_goals
from .layers import DRAWN
from .meshes import mesh_from_arrays
from .sketch import Drawn
from .snapping import as_drawn
from .snapping import find_constraints
from .snapping import snap_distance
from .units import set_north
from .units import unit_system
from .user_text import constraint_text
from .user_text import drawn_text
from .user_text import vertex_text

__all__ = ["LayerWriter", "draw_problem", "new_archive", "write_problem"]

_Colour = tuple[int, int, int]

rhino3dm = rhino3dm_module()


class LayerWriter:
    """Writer of objects to the layers of an archive.

    Parameters
    ----------
    archive
        A new archive, or one that was read.
    """

    def __init__(self, archive: Archive):
        self.archive = archive

    def clear(self, parent: str) -> None:
        """Delete everything on a layer and its sublayers."""
        within = {layer.Index for layer in self.archive.Layers if f"{layer.FullPath or layer.Name}::".startswith(f"{parent}::")}
        for name in [str(entry.Attributes.Id) for entry in self.archive.Objects if entry.Attributes.LayerIndex in within]:
            self.archive.Objects.Delete(name)

    def layer(self, path: str, colour: _Colour = (0, 0, 0), visible: bool = True) -> int:
        """Return the index of a layer (full path); create it and its parents if necessary."""
        found = {layer.FullPath or layer.Name: layer.Index for layer in self.archive.Layers}
        if path in found:
            return found[path]
        parent, _, name = path.rpartition("::")
        layer = rhino3dm.Layer()
        layer.Name, layer.Color, layer.Visible = name, (*colour, 255), visible
        if parent:
            above = self.layer(parent)
            layer.ParentLayerId = next(other.Id for other in self.archive.Layers if other.Index == above)
        return self.archive.Layers.Add(layer)

    def attributes(
        self, layer: int, name: str = "", text: Optional[Mapping[str, str]] = None, colour: Optional[_Colour] = None
    ) -> ObjectAttributes:
        """Return the attributes of an object: layer, name, user text and colour."""
        attributes = rhino3dm.ObjectAttributes()
        attributes.LayerIndex, attributes.Name = layer, name
        for key, value in (text or {}).items():
            attributes.SetUserString(key, value)
        if colour is not None:
            attributes.ObjectColor, attributes.ColorSource = (*colour, 255), rhino3dm.ObjectColorSource.ColorFromObject
        return attributes

    def mesh(self, mesh: Mesh, attributes: ObjectAttributes) -> None:
        """Add a mesh."""
        self.archive.Objects.AddMesh(mesh, attributes)

    def points(self, points: FloatArray, attributes: ObjectAttributes) -> None:
        """Add points (k, 3) [L]."""
        for x, y, z in np.asarray(points, dtype=np.float64).tolist():
            self.archive.Objects.AddPoint(rhino3dm.Point3d(x, y, z), attributes)

    def cloud(self, points: FloatArray, attributes: ObjectAttributes) -> None:
        """Add points (k, 3) [L] as one object, a point cloud if there are several."""
        if len(points) == 1:
            self.points(points, attributes)
            return
        cloud = rhino3dm.PointCloud()
        for x, y, z in np.asarray(points, dtype=np.float64).tolist():
            cloud.Add(rhino3dm.Point3d(x, y, z))
        self.archive.Objects.AddPointCloud(cloud, attributes)

    def polyline(self, points: FloatArray, attributes: ObjectAttributes) -> None:
        """Add a polyline through points (k, 3) [L]."""
        line = [rhino3dm.Point3d(x, y, z) for x, y, z in np.asarray(points, dtype=np.float64).tolist()]
        self.archive.Objects.AddPolyline(line, attributes)

    def dot(self, text: str, place: Union[FloatArray, Sequence[float]], attributes: ObjectAttributes) -> None:
        """Add a text dot at a place (3,) [L]."""
        self.archive.Objects.AddTextDot(text, rhino3dm.Point3d(*(float(x) for x in place)), attributes)

    def document_text(self, texts: Iterable[tuple[str, str]]) -> None:
        """Set document user text."""
        for key, value in texts:
            self.archive.Strings[key] = value


@names_what_was_meant()
def write_problem(path: Union[str, os.PathLike], problem: PosesProblem, version: int = 7) -> None:
    """Write a problem on the standard layers: mesh, supports, creases, constraints, and a text dot with the target or law of each region.

    Coordinates and targets are read back without loss. Dummy vertices are omitted.

    Parameters
    ----------
    path
        The .3dm file; an existing file is replaced when the new one is complete.
    problem
        A problem or mesh, written in its units, by default metres.
    version
        7 (opens in Rhino 7 and later) or 8.

    Raises
    ------
    FileError
        If the file cannot be written.

    Examples
    --------
    >>> import compas_cgc, os, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_problem(os.path.join(folder, "plan.3dm"), compas_cgc.CGCMesh.from_meshgrid(dx=4.0, nx=4))
    ...     print(os.listdir(folder))
    ['plan.3dm']
    """
    own = problem.to_problem().without_dummies()
    writer = LayerWriter(new_archive(own))
    draw_problem(writer, own, "CGC", mesh_from_arrays(own.vertices, own.faces))
    on_targets = writer.layer("CGC::Targets", (30, 130, 60))
    label = own.regions()
    for region, law in enumerate(own.region_laws()):
        if law is not None:
            place = _inside(own.vertices, own.faces[label == region])
            writer.dot(
                str(law).replace("K = ", "K=") if isinstance(law, ConstantCurvature) else str(law),
                place,
                writer.attributes(on_targets, f"region {region}"),
            )
    write_archive(writer.archive, path, version)


def new_archive(problem: CGCProblem) -> Archive:
    """Return an empty archive for a problem, by default in metres, with a tolerance relative to its size."""
    archive = rhino3dm.File3dm()
    archive.ApplicationName = "compas_cgc"
    archive.ApplicationDetails = f"compas_cgc {__version__}"
    archive.Settings.ModelUnitSystem = unit_system(problem.drawing.units or "Meters")
    archive.Settings.ModelAbsoluteTolerance = problem.drawing.tolerance or _tolerance(problem.vertices)
    set_north(archive, problem.drawing.north)
    return archive


def draw_problem(writer: LayerWriter, problem: CGCProblem, parent: str, mesh: Mesh, text: Optional[dict[str, str]] = None) -> None:
    """Draw a mesh, supports as points, creases as polylines and constraints on the sublayers of `parent`, and the drawing of a result.

    The user text of the mesh is `text` and the data of the problem that cannot be drawn.
    """
    drawn, goals, others = _drawable(problem, float(writer.archive.Settings.ModelAbsoluteTolerance))
    texts = {**(text or {}), **vertex_text(problem), **constraint_text(others, len(problem.vertices))}
    on_mesh = writer.layer(f"{parent}::Mesh", (120, 120, 120))
    writer.mesh(mesh, writer.attributes(on_mesh, problem.drawing.name, texts))
    earlier = problem.drawn
    if earlier is not None:
        on_drawn = writer.layer(f"{parent}::{DRAWN}", (150, 150, 150), visible=False)
        writer.mesh(mesh_from_arrays(earlier.vertices, earlier.faces), writer.attributes(on_drawn, "drawn", drawn_text(problem)))
    on_supports = writer.layer(f"{parent}::Supports", (200, 30, 30))
    writer.points(problem.vertices[problem.supports], writer.attributes(on_supports))
    on_creases = writer.layer(f"{parent}::Creases", (20, 60, 160))
    for path in problem.crease_paths():
        writer.polyline(problem.vertices[path], writer.attributes(on_creases))
    _draw_goals(writer, problem, goals, f"{parent}::Goals")
    on_constraints = writer.layer(f"{parent}::Constraints", (120, 40, 140)) if drawn else -1
    for item in drawn:
        draw = writer.polyline if item.kind == "curve" else writer.cloud
        draw(item.points, writer.attributes(on_constraints, text=item.text))


def _draw_goals(writer: LayerWriter, problem: CGCProblem, goals: list[Drawn], layer: str) -> None:
    """Draw goals with their user text, and named places."""
    if not goals and not problem.drawing.places:
        return
    on_goals = writer.layer(layer, (20, 110, 120))
    for item in goals:
        draw = writer.polyline if item.kind == "curve" else writer.cloud
        draw(item.points, writer.attributes(on_goals, text=item.text))
    for name, line in problem.drawing.places:
        plan = np.array([*line, line[0]], dtype=np.float64)[:, :2]
        writer.polyline(flattened(plan), writer.attributes(on_goals, name))


def _drawable(problem: CGCProblem, tolerance: float) -> tuple[list[Drawn], list[Drawn], list[Constraint]]:
    """Return constraints and goals as drawn objects, and those that cannot be read back from drawn objects."""
    V = problem.vertices
    snap = snap_distance(V, problem.faces, tolerance) if problem.goals else 0.0
    drawn, goals, others = [], [], []
    for constraint in problem.goals:
        goal = drawn_goal(constraint, V)
        if goal is not None:
            again = find_goals([goal], V, snap).goals
            if [_plain(constraint)] == [_plain(other) for other in again]:
                goals.append(goal)
                continue
        item = as_drawn(constraint, V)
        found = [] if item is None else find_constraints([item], V, snap, "")[0]
        if item is not None and [_plain(constraint)] == [_plain(other) for other in found]:
            drawn.append(item)
        else:
            others.append(constraint)
    return drawn, goals, others


def _plain(constraint: Constraint) -> dict:
    data = constraint_data(constraint)
    if isinstance(constraint, Clearance) and not isinstance(constraint.where, (int, np.integer)):
        return {**data, "where": constraint.outline().tolist()}
    if isinstance(constraint, Within):
        return {**data, "points": in_plan(constraint.points, "points", 3).tolist()}
    vertices = data.get("vertices")
    return data if not isinstance(vertices, list) or isinstance(constraint, Length) else {**data, "vertices": sorted(set(vertices))}


def _tolerance(vertices: FloatArray) -> float:
    """Return a ten-thousandth of the size, rounded down to a power of ten, at most 0.001 [L]."""
    size = float(np.linalg.norm(np.ptp(vertices, axis=0))) if len(vertices) else 0.0
    return min(1e-3, 10.0 ** math.floor(math.log10(1e-4 * size))) if size > 0 else 1e-3


def _inside(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Return the centre of the face nearest to the middle of a region (3,) [L]."""
    centres = vertices[faces].mean(axis=1)
    return centres[np.argmin(np.linalg.norm(centres - centres.mean(axis=0), axis=1))]
