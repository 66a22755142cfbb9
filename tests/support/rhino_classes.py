"""Small stand-ins for the names of Rhino and Grasshopper that the components use, on the standard library alone.

They raise where the real ones would: unknown names, single precision where it would be
lost, balloons and schedules with the wrong arguments.
"""

from __future__ import annotations

import decimal
import json
import types
import uuid
from typing import NamedTuple


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


class Geometry:
    """What the geometry of Rhino has in common."""

    def parts(self):
        raise NotImplementedError

    def DataCRC(self, remainder):
        assert remainder == 0
        return hash(tuple(map(tuple, self.parts())))


class Mesh(Geometry):
    def __init__(self):
        self.Vertices, self.Faces, self.VertexColors, self.Normals = Vertices(), Faces(), Colours(), Normals()

    def parts(self):
        return self.Vertices, self.Faces


class PolylineCurve(Geometry):
    def __init__(self, points):
        self.points = list(points)

    def parts(self):
        return [self.points]

    def TryGetPolyline(self):
        return True, list(self.points)


class SmoothCurve(PolylineCurve):
    """A curve that is no polyline, known by points along it."""

    def TryGetPolyline(self):
        return False, None

    def ToPolyline(self, tolerance, angle_tolerance, minimum, maximum):
        assert tolerance > 0
        return types.SimpleNamespace(PointCount=len(self.points), Point=lambda i: self.points[i])


class SerializationOptions:
    pass


class Brep(Geometry):
    """A surface of any kind, which Rhino and rhino3dm encode alike."""

    Faces = Edges = Vertices = ()

    def __init__(self, inner):
        self.inner = inner

    def parts(self):
        return [[None if self.inner is None else json.dumps(self.inner.Encode())]]

    def ToJSON(self, options):
        assert isinstance(options, SerializationOptions)
        return json.dumps(self.inner.Encode())


class SubD(Brep):
    pass


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


class ValueTable:
    """Texts that are saved with a definition."""

    def __init__(self):
        self.texts = {}

    def SetValue(self, key, text):
        assert type(key) is str and type(text) is str
        self.texts[key] = text

    def GetValue(self, key, default):
        return self.texts.get(key, default)

    def DeleteValue(self, key):
        self.texts.pop(key, None)


class Document:
    """A canvas that runs scheduled solutions on request."""

    def __init__(self):
        self.scheduled = []
        self.objects = []
        self.components = []
        self.ValueTable = ValueTable()

    def FindObject(self, id, top_level_only):
        assert top_level_only is True
        return next((one for one in self.components if one.InstanceGuid == id and one.document is self), None)

    def AddObject(self, made, update):
        assert update is False and made.Attributes is not None
        self.objects.append(made)

    def close(self):
        """Close it: nothing that is scheduled runs any more."""
        self.scheduled = []
        Instances.DocumentServer.DocumentRemoved.raised(Instances.DocumentServer, self)

    def ScheduleSolution(self, milliseconds, delegate):
        assert type(milliseconds) is int and milliseconds > 0 and isinstance(delegate, ScheduleDelegate)
        self.scheduled.append(delegate)

    def tick(self):
        """Run what is scheduled by now."""
        due, self.scheduled = self.scheduled, []
        for delegate in due:
            delegate.callback(self)
        return len(due)


class Event:
    """What handlers are added to and removed from; other handlers cannot be seen."""

    def __init__(self):
        self.handlers = []

    def __iadd__(self, handler):
        self.handlers.append(handler)
        return self

    def __isub__(self, handler):
        assert handler in self.handlers
        self.handlers.remove(handler)
        return self

    def raised(self, *arguments):
        for handler in list(self.handlers):
            handler(*arguments)


class Instances:
    DocumentServer = types.SimpleNamespace(DocumentRemoved=Event())


class Attributes:
    """Where an object is; its size is known after a layout only."""

    def __init__(self):
        self.Pivot, self.Bounds = PointF(0.0, 0.0), None

    def PerformLayout(self):
        self.Bounds = types.SimpleNamespace(X=self.Pivot.X - 40.0, Y=self.Pivot.Y, Width=120.0, Height=22.0)

    def ExpireLayout(self):
        pass


class PointF(NamedTuple):
    X: float
    Y: float


class NetList(list):
    """A .NET list."""

    Add, Clear = list.append, list.clear


class ValueListItem(NamedTuple):
    Name: str
    Expression: str


class ValueList:
    Attributes = None

    def __init__(self):
        self.ListItems, self.chosen = NetList(ValueListItem(name, name) for name in ("One", "Two")), None

    def SelectItem(self, index):
        self.chosen = self.ListItems[index].Name

    def CreateAttributes(self):
        self.Attributes = Attributes()


class NumberSlider:
    Attributes = None

    def __init__(self):
        self.Slider = types.SimpleNamespace(DecimalPlaces=3, Minimum=decimal.Decimal(0), Maximum=decimal.Decimal(1), Value=None)

    def SetSliderValue(self, value):
        assert isinstance(value, decimal.Decimal) and self.Slider.Minimum <= value <= self.Slider.Maximum
        self.Slider.Value = round(value, self.Slider.DecimalPlaces)

    def CreateAttributes(self):
        self.Attributes = Attributes()


class Parameter:
    """An input of a component."""

    def __init__(self, name, y):
        self.Name, self.Sources, self.Attributes = name, [], Attributes()
        self.Attributes.Pivot = PointF(300.0, y)

    @property
    def SourceCount(self):
        return len(self.Sources)

    def AddSource(self, source):
        self.Sources.append(source)


class Path:
    def __init__(self, *indices):
        assert all(type(index) is int for index in indices)
        self.Indices = indices

    @property
    def key(self):
        return self.Indices[0] if len(self.Indices) == 1 else self.Indices

    def AppendElement(self, index):
        return Path(*self.Indices, index)


class DataTree:
    """A tree with a branch for every path."""

    def __class_getitem__(cls, kind):
        return cls

    Paths = ()

    def __init__(self, branches=()):
        self.branches, self.Paths = {}, []
        for indices, items in dict(branches).items():
            self.EnsurePath(Path(*indices))
            self.branches[self.Paths[-1].key] = list(items)

    def EnsurePath(self, path):
        if path.key not in self.branches:
            self.branches[path.key] = []
            self.Paths.append(path)

    def Add(self, value, path):
        self.branches[path.key].append(value)

    def Branch(self, path):
        return list(self.branches[path.key])

    def AllData(self):
        return [value for path in self.Paths for value in self.branches[path.key]]


class ScheduleDelegate:
    def __init__(self, callback):
        self.callback = callback


class Layer:
    Name, Color, ParentLayerId, Id = "", None, None, None


class ObjectAttributes:
    def __init__(self):
        self.Name, self.LayerIndex, self.text = "", 0, {}

    def SetUserString(self, key, value):
        assert type(key) is str and type(value) is str and value
        self.text[key] = value


class Layers(list):
    """The layers of a document."""

    def full_path(self, layer):
        above = [other for other in self if other.Id == layer.ParentLayerId]
        return f"{self.full_path(above[0])}::{layer.Name}" if above else layer.Name

    def FindByFullPath(self, path, missing):
        return next((i for i, layer in enumerate(self) if self.full_path(layer) == path), missing)

    def Add(self, layer):
        if not layer.Name or "::" in layer.Name:
            return -1
        layer.Id = uuid.uuid4()
        self.append(layer)
        return len(self) - 1


class Objects(dict):
    """The objects of a document, by their ids."""

    def _add(self, geometry, attributes):
        id = uuid.uuid4()
        self[id] = types.SimpleNamespace(Id=id, Geometry=geometry, Attributes=attributes)
        return id

    AddMesh = AddCurve = AddPoint = _add

    def FindByUserString(self, key, value, case_sensitive):
        assert case_sensitive is True
        return [one for one in self.values() if one.Attributes.text.get(key) == value]

    def FindId(self, id):
        return self.get(id)

    def Delete(self, one, quiet):
        assert quiet is True
        return self.pop(one.Id, None) is not None


class RhinoDoc:
    ModelAbsoluteTolerance = 0.001
    ModelUnitSystem = "Meters"

    def __init__(self):
        self.Layers, self.Objects, self.undo, self.open = Layers(), Objects(), [], 0
        self.Views = types.SimpleNamespace(Redraw=lambda: None)

    def BeginUndoRecord(self, name):
        self.open += 1
        self.undo.append(name)
        return len(self.undo)

    def EndUndoRecord(self, number):
        assert number == len(self.undo)
        self.open -= 1


class Component:
    """What ``ghenv.Component`` is."""

    def __init__(self, document, inputs=()):
        self.InstanceGuid = uuid.uuid4()
        self.Message = ""
        self.document = document
        document.components.append(self)
        self.balloons = []
        self.expired = True
        self.RunCount = 1
        self.Locked = False
        self.Params = types.SimpleNamespace(Input=[Parameter(name, 20.0 * i) for i, name in enumerate(inputs)])

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
    geometry = module(
        "Rhino.Geometry",
        Mesh=Mesh,
        Point3d=Point3d,
        PolylineCurve=PolylineCurve,
        Curve=PolylineCurve,
        Plane=Plane,
        GeometryBase=object,
    )
    levels = types.SimpleNamespace(Remark="Remark", Warning="Warning", Error="Error")
    document = types.SimpleNamespace(GH_ScheduleDelegate=ScheduleDelegate)
    special = module("Grasshopper.Kernel.Special", GH_ValueList=ValueList, GH_ValueListItem=ValueListItem, GH_NumberSlider=NumberSlider)
    data = module("Grasshopper.Kernel.Data", GH_Path=Path)
    kernel = module("Grasshopper.Kernel", GH_ScriptInstance=object, GH_RuntimeMessageLevel=levels, GH_Document=document, Special=special)
    generic = module("System.Collections.Generic", List=List)
    collections = module("System.Collections", Generic=generic)
    drawing = module("System.Drawing", Color=Colour, PointF=PointF)
    objects = module("Rhino.DocObjects", Layer=Layer, ObjectAttributes=ObjectAttributes)
    files = module("Rhino.FileIO", SerializationOptions=SerializationOptions)
    values = {"Object": object, "Guid": uuid.UUID, "Exception": Exception, "Decimal": decimal.Decimal}
    found = [
        module("Rhino", Geometry=geometry, FileIO=files, RhinoDoc=types.SimpleNamespace(ActiveDoc=RhinoDoc()), DocObjects=objects),
        objects,
        files,
        geometry,
        module("Grasshopper", Kernel=kernel, Instances=Instances, DataTree=DataTree),
        special,
        data,
        kernel,
        module("System", Collections=collections, Drawing=drawing, **values),
        collections,
        generic,
        drawing,
    ]
    return {made.__name__: made for made in found}


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
