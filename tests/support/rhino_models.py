"""Rhino files as architects hand them over."""

from __future__ import annotations

import json

import numpy as np
import rhino3dm

from compas_cgc.io.rhino.meshes import mesh_to_arrays

from .shapes import grid

ORIGINS = [(0.0, 0.0, 0.0), (1e3, -2e3, 300.0)]


class Sketch:
    """A .3dm file in the making."""

    def __init__(self, units="Meters", tolerance=1e-3):
        self.file = rhino3dm.File3dm()
        self.file.Settings.ModelUnitSystem = getattr(rhino3dm.UnitSystem, units)
        self.file.Settings.ModelAbsoluteTolerance = tolerance

    def on(self, layer="", text=None, name="", visible=True):
        """Return attributes on a layer (``A::B`` for sublayers), with user text."""
        attributes = rhino3dm.ObjectAttributes()
        attributes.Name, attributes.Visible = name, visible
        for key, value in (text or {}).items():
            attributes.SetUserString(key, value)
        above = None
        path = ""
        for part in layer.split("::") if layer else []:
            path = f"{path}::{part}" if path else part
            found = [other for other in self.file.Layers if other.FullPath == path]
            if not found:
                new = rhino3dm.Layer()
                new.Name = part
                if above is not None:
                    new.ParentLayerId = above.Id
                self.file.Layers.Add(new)
                found = [other for other in self.file.Layers if other.FullPath == path]
            above = found[0]
            attributes.LayerIndex = above.Index
        return attributes

    def mesh(self, vertices, faces, layer="", text=None, single=False, **options):
        """Add a mesh of triangles and quads."""
        mesh = rhino3dm.Mesh()
        for point in np.asarray(vertices, dtype=float).tolist():
            (mesh.Vertices.Add if single else mesh.Vertices.AddPoint3d)(*point)
        for face in faces:
            mesh.Faces.AddFace(*(int(v) for v in face))
        return str(self.file.Objects.AddMesh(mesh, self.on(layer, text, **options)))

    def points(self, places, layer="", text=None, **options):
        """Add points."""
        return [str(self.file.Objects.AddPoint(point3d(p), self.on(layer, text, **options))) for p in places]

    def cloud(self, places, layer=""):
        """Add a point cloud."""
        cloud = rhino3dm.PointCloud()
        for place in places:
            cloud.Add(point3d(place))
        return str(self.file.Objects.AddPointCloud(cloud, self.on(layer)))

    def curve(self, curve, layer="", text=None, **options):
        """Add a curve, or a polyline through points."""
        if not isinstance(curve, rhino3dm.Curve):
            curve = polyline(curve)
        return str(self.file.Objects.AddCurve(curve, self.on(layer, text, **options)))

    def dot(self, words, place, layer=""):
        """Add a text dot."""
        return str(self.file.Objects.AddTextDot(words, point3d(place), self.on(layer)))

    def save(self, path, version=7):
        """Write the file and return its path."""
        assert self.file.Write(str(path), version)
        return path


def place_of(points):
    """Return how messages state the place of an object around points."""
    middle = 0.5 * (np.min(points, axis=0) + np.max(points, axis=0))
    return f"at ({', '.join(f'{value:.6g}' for value in middle.tolist())})"


def point3d(place):
    return rhino3dm.Point3d(*(float(x) for x in place))


def polyline(points):
    line = rhino3dm.Polyline(len(points))
    for p in np.asarray(points, dtype=float).tolist():
        line.Add(*p)
    return line.ToPolylineCurve()


def quads(n, width=1.0):
    """Return a grid of n by n squares as quads."""
    vertices, _ = grid(n, width)
    a = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    return vertices, np.column_stack([a, a + n + 1, a + n + 2, a + 1])


def corners_of(n):
    """Return the corner vertices of a grid."""
    return [0, n, n * (n + 1), (n + 1) ** 2 - 1]


def row(n, i):
    """Return the vertices of a grid's line i."""
    return list(range(i * (n + 1), (i + 1) * (n + 1)))


def result_of(path):
    """Return vertices and faces of the solved mesh in a file, and the record of its solve."""
    file = rhino3dm.File3dm.Read(str(path))
    (layer,) = [layer.Index for layer in file.Layers if layer.FullPath == "CGC Result::Mesh"]
    (mesh,) = [item.Geometry for item in file.Objects if item.Attributes.LayerIndex == layer]
    vertices, faces = mesh_to_arrays(mesh)
    return vertices, faces[:, :3], json.loads(file.Strings["compas_cgc.result"])


def dots_of(path):
    """Return the texts of the dots in a file."""
    return [item.Geometry.Text for item in rhino3dm.File3dm.Read(str(path)).Objects if isinstance(item.Geometry, rhino3dm.TextDot)]
