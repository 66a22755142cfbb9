"""Create the two Rhino files of this folder, in the form in which an architect would draw them."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import rhino3dm

COLOURS = {"Mesh": (160, 160, 160, 255), "Supports": (200, 0, 0, 255), "Creases": (0, 0, 0, 255), "Targets": (0, 120, 0, 255)}


def new_file() -> tuple[rhino3dm.File3dm, dict[str, rhino3dm.ObjectAttributes]]:
    """Return an empty file in metres with layers for mesh, supports, creases and targets."""
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Meters
    model.Settings.ModelAbsoluteTolerance = 0.001
    attributes = {}
    for name, colour in COLOURS.items():
        layer = rhino3dm.Layer()
        layer.Name, layer.Color = name, colour
        attributes[name] = rhino3dm.ObjectAttributes()
        attributes[name].LayerIndex = model.Layers.Add(layer)
    return model, attributes


def square_roof(path: Path, side: float = 15.0, cells: int = 15) -> None:
    """Write a square roof on four corner points, divided into nine squares by four lines."""
    model, on = new_file()
    mesh = rhino3dm.Mesh()
    step = side / cells
    for i in range(cells + 1):
        for j in range(cells + 1):
            mesh.Vertices.AddPoint3d(i * step, j * step, 0.0)
    for i in range(cells):
        for j in range(cells):
            a = i * (cells + 1) + j
            mesh.Faces.AddFace(a, a + cells + 1, a + cells + 2, a + 1)
    mesh.Normals.ComputeNormals()
    model.Objects.AddMesh(mesh, on["Mesh"])
    for x in (0.0, side):
        for y in (0.0, side):
            model.Objects.AddPoint(rhino3dm.Point3d(x, y, 0.0), on["Supports"])
    # Four times the curvature in the middle.
    for i in range(3):
        for j in range(3):
            place = rhino3dm.Point3d((i + 0.5) * side / 3, (j + 0.5) * side / 3, 0.0)
            model.Objects.AddTextDot("K=0.04" if i == j == 1 else "K=0.01", place, on["Targets"])
    for t in (side / 3, 2 * side / 3):
        for begin, end in (((t, 0.0), (t, side)), ((0.0, t), (side, t))):
            line = rhino3dm.LineCurve(rhino3dm.Point3d(*begin, 0.0), rhino3dm.Point3d(*end, 0.0))
            model.Objects.AddCurve(line, on["Creases"])
    model.Write(str(path), 7)


def free_form_plan(path: Path, rows: int = 24, radius: float = 20.0) -> None:
    """Write a leaf-shaped plan that is supported along its edge, with one crease along a circular arc.

    The mesh is a strip of triangles. Its middle row follows the arc, and its outer rows follow two other curves.
    """
    model, on = new_file()
    mesh = rhino3dm.Mesh()
    half = 10.0

    def arc(x: float) -> float:
        return math.sqrt(radius**2 - x**2) - radius + 2.0

    def edge(x: float, above: bool) -> float:
        width = math.sqrt(max(0.0, 1.0 - (x / (half * 1.12)) ** 2))
        return arc(x) + (5.5 + 0.10 * x) * width if above else arc(x) - (6.5 - 0.15 * x) * width

    across = 12
    index = {}
    for i in range(rows + 1):
        for j in range(across + 1):
            x = -half + 2 * half * i / rows
            t = 2 * j / across - 1
            y = arc(x) + abs(t) * (edge(x, t > 0) - arc(x))
            index[i, j] = mesh.Vertices.AddPoint3d(x, y, 0.0)
    for i in range(rows):
        for j in range(across):
            a, b, c, d = index[i, j], index[i + 1, j], index[i + 1, j + 1], index[i, j + 1]
            mesh.Faces.AddFace(a, b, c)
            mesh.Faces.AddFace(a, c, d)
    mesh.Normals.ComputeNormals()
    model.Objects.AddMesh(mesh, on["Mesh"])
    rim = [at for at in index if at[0] in (0, rows) or at[1] in (0, across)]
    cloud = rhino3dm.PointCloud()
    for i, j in rim:
        x = -half + 2 * half * i / rows
        t = 2 * j / across - 1
        cloud.Add(rhino3dm.Point3d(x, arc(x) + abs(t) * (edge(x, t > 0) - arc(x)), 0.0))
    model.Objects.AddPointCloud(cloud, on["Supports"])
    ends = [rhino3dm.Point3d(x, arc(x), 0.0) for x in (-half, 0.0, half)]
    crease = rhino3dm.Arc(*ends).ToNurbsCurve()
    model.Objects.AddCurve(crease, on["Creases"])
    model.Write(str(path), 7)


def main(folder: Path) -> None:
    """Write both files."""
    square_roof(folder / "nine_regions.3dm")
    free_form_plan(folder / "curved_crease.3dm")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
