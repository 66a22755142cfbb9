"""Small stand-ins for the names of Rhino and Grasshopper that the components use.

They raise where the real ones would: unknown names, single precision where it would be
lost, balloons and schedules with the wrong arguments.
"""

from __future__ import annotations

import sys
import types
import uuid
from typing import NamedTuple

import pytest

# COMPAS looks for Rhino when it is loaded; it must not find the stand-ins.
import compas_cgc.datastructures  # noqa: F401
from compas_cgc.grasshopper.build.component_manifest import Bundle
from compas_cgc.grasshopper.build.component_manifest import read_bundles


class Point3d(NamedTuple):
    X: float
    Y: float
    Z: float


class Plane(NamedTuple):
    Origin: Point3d
    ZAxis: Point3d


class MeshFace(NamedTuple):
    A: int
    B: int
    C: int
    D: int


class Vertices(list):
    UseDoublePrecisionVertices = False

    def Add(self, x, y, z):
        assert self.UseDoublePrecisionVertices, "digits would be lost"
        assert all(type(value) is float for value in (x, y, z))
        self.append(Point3d(x, y, z))

    def ToPoint3dArray(self):
        return list(self)


class Faces(list):
    def AddFace(self, a, b, c, d=None):
        assert all(type(value) is int for value in (a, b, c))
        self.append(MeshFace(a, b, c, c if d is None else d))


class Colours(list):
    def Add(self, red, green, blue):
        assert all(type(value) is int and 0 <= value <= 255 for value in (red, green, blue))
        self.append((red, green, blue))


class Normals(list):
    computed = False

    def ComputeNormals(self):
        self.computed = True
        return True


class Mesh:
    def __init__(self):
        self.Vertices, self.Faces, self.VertexColors, self.Normals = Vertices(), Faces(), Colours(), Normals()


class PolylineCurve:
    def __init__(self, points):
        self.points = list(points)

    def TryGetPolyline(self):
        return True, list(self.points)


class SmoothCurve:
    """A curve that is no polyline, known by points along it."""

    def __init__(self, points):
        self.points = list(points)

    def TryGetPolyline(self):
        return False, None

    def ToPolyline(self, tolerance, angle_tolerance, minimum, maximum):
        assert tolerance > 0
        return types.SimpleNamespace(PointCount=len(self.points), Point=lambda i: self.points[i])


class Colour(NamedTuple):
    R: int
    G: int
    B: int

    @classmethod
    def FromArgb(cls, red, green, blue):
        assert all(type(value) is int for value in (red, green, blue))
        return cls(red, green, blue)


class List:
    def __class_getitem__(cls, kind):
        return cls


class Document:
    """A canvas that runs what is scheduled when it is told to."""

    def __init__(self):
        self.scheduled = []

    def ScheduleSolution(self, milliseconds, delegate):
        assert type(milliseconds) is int and milliseconds > 0 and isinstance(delegate, ScheduleDelegate)
        self.scheduled.append(delegate)

    def tick(self):
        """Run what is scheduled by now."""
        due, self.scheduled = self.scheduled, []
        for delegate in due:
            delegate.callback(self)
        return len(due)


class ScheduleDelegate:
    def __init__(self, callback):
        self.callback = callback


class RhinoDoc:
    ModelAbsoluteTolerance = 0.001
    ModelUnitSystem = "Meters"


class Component:
    """What ``ghenv.Component`` is."""

    def __init__(self, document):
        self.InstanceGuid = uuid.uuid4()
        self.Message = ""
        self.document = document
        self.balloons = []
        self.expired = True
        self.RunCount = 1

    def AddRuntimeMessage(self, level, text):
        assert level in ("Remark", "Warning", "Error") and type(text) is str and text
        self.balloons.append((level, text))

    def OnPingDocument(self):
        return self.document

    def ExpireSolution(self, recompute):
        assert recompute is False, "a scheduled solution must not start another one"
        self.expired = True


def module(name, **names):
    made = types.ModuleType(name)
    made.__dict__.update(names)
    return made


def modules():
    """Return the stand-ins by the names of their modules."""
    geometry = module("Rhino.Geometry", Mesh=Mesh, Point3d=Point3d, PolylineCurve=PolylineCurve, Curve=PolylineCurve, Plane=Plane)
    levels = types.SimpleNamespace(Remark="Remark", Warning="Warning", Error="Error")
    document = types.SimpleNamespace(GH_ScheduleDelegate=ScheduleDelegate)
    kernel = module("Grasshopper.Kernel", GH_ScriptInstance=object, GH_RuntimeMessageLevel=levels, GH_Document=document)
    generic = module("System.Collections.Generic", List=List)
    collections = module("System.Collections", Generic=generic)
    drawing = module("System.Drawing", Color=Colour)
    found = [
        module("Rhino", Geometry=geometry, RhinoDoc=types.SimpleNamespace(ActiveDoc=RhinoDoc)),
        geometry,
        module("Grasshopper", Kernel=kernel),
        kernel,
        module("System", Collections=collections, Drawing=drawing),
        collections,
        generic,
        drawing,
    ]
    return {made.__name__: made for made in found}


@pytest.fixture
def rhino(monkeypatch):
    """Put the stand-ins where imports find them."""
    for name, made in modules().items():
        monkeypatch.setitem(sys.modules, name, made)


class Placed:
    """A component on a canvas, run as Grasshopper runs it."""

    def __init__(self, bundle: Bundle, document=None):
        self.bundle = bundle
        self.component = Component(Document() if document is None else document)
        space = {"ghenv": types.SimpleNamespace(Component=self.component)}
        exec(compile(bundle.code, f"{bundle.key}/code.py", "exec"), space)
        (self.script,) = [value for value in space.values() if isinstance(value, type) and value.__module__ == "builtins"]

    def run(self, **inputs):
        """Return the outputs by name; inputs that are not named are not connected."""
        assert set(inputs) <= {parameter.name for parameter in self.bundle.inputs}
        self.component.balloons.clear()
        self.component.expired = False
        given = [inputs.get(parameter.name) for parameter in self.bundle.inputs]
        returned = self.script().RunScript(*given)
        names = [parameter.name for parameter in self.bundle.outputs]
        return dict(zip(names, returned if len(names) > 1 else [returned]))

    def said(self, level):
        """Return the texts of the balloons of a level."""
        return [text for own, text in self.component.balloons if own == level]


BUNDLES = {bundle.key: bundle for bundle in read_bundles()}


def place(name, document=None):
    """Put a component on a canvas."""
    return Placed(BUNDLES[f"CGC_{name}"], document)


def rhino_mesh(vertices, faces):
    """Return a mesh as Grasshopper would bring it."""
    mesh = Mesh()
    mesh.Vertices.UseDoublePrecisionVertices = True
    for x, y, z in vertices:
        mesh.Vertices.Add(float(x), float(y), float(z))
    for face in faces:
        mesh.Faces.AddFace(*map(int, face))
    return mesh


def square(n=9, width=9.0):
    """Return a flat mesh of n by n quads."""
    points = [(width * i / n, width * j / n, 0.0) for i in range(n + 1) for j in range(n + 1)]
    m = n + 1
    return rhino_mesh(points, [(i * m + j, (i + 1) * m + j, (i + 1) * m + j + 1, i * m + j + 1) for i in range(n) for j in range(n)])
