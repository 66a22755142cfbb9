"""Conversion inside Rhino, with a stand-in that makes the same calls and has the same trap: single-precision vertices."""

from __future__ import annotations

import sys
from types import ModuleType
from types import SimpleNamespace

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc.io.rhino import rhinocommon as inside

from ...support.rhino_models import corners_of
from ...support.rhino_models import row
from ...support.shapes import grid

N = 6


class Point3d(SimpleNamespace):
    def __init__(self, x, y, z):
        super().__init__(X=x, Y=y, Z=z)


class Vertices:
    """MeshVertexList of RhinoCommon: doubles are kept only when it was told so, items are always single."""

    def __init__(self):
        self.UseDoublePrecisionVertices = False
        self.double = []

    def Add(self, x, y, z):
        assert type(x) is float
        self.double.append((x, y, z) if self.UseDoublePrecisionVertices else tuple(map(float, np.float32([x, y, z]))))

    def __getitem__(self, i):
        return Point3d(*map(float, np.float32(self.double[i])))

    def ToPoint3dArray(self):
        return [Point3d(*p) for p in self.double]


class Faces(list):
    def AddFace(self, a, b, c, d=None):
        assert type(a) is int
        self.append(SimpleNamespace(A=a, B=b, C=c, D=c if d is None else d))


class Mesh:
    def __init__(self):
        self.Vertices, self.Faces = Vertices(), Faces()
        self.VertexColors = SimpleNamespace(rows=[])
        self.VertexColors.Add = lambda *rgb: self.VertexColors.rows.append(rgb)
        self.Normals = SimpleNamespace(ComputeNormals=lambda: setattr(self, "normals", True))


class Curve:
    """A curve that is no polyline, or one that is."""

    def __init__(self, points, exact=True):
        self.points, self.exact = [Point3d(*map(float, p)) for p in points], exact

    def TryGetPolyline(self):
        return self.exact, self.points if self.exact else None

    def ToPolyline(self, tolerance, angle, shortest, longest):
        return SimpleNamespace(PointCount=len(self.points), Point=self.points.__getitem__)


@pytest.fixture(autouse=True)
def rhino(monkeypatch):
    module = ModuleType("Rhino")
    module.Geometry = SimpleNamespace(Mesh=Mesh, Point3d=Point3d)
    monkeypatch.setitem(sys.modules, "Rhino", module)


def far_grid():
    vertices, faces = grid(N, 2.0)
    return vertices + [1000 + 1 / 3, 0, 0], faces


def test_a_mesh_goes_in_and_out_with_every_bit():
    vertices, faces = far_grid()
    mesh = inside.mesh_from_arrays(vertices, faces, np.tile([1, 2, 3], (len(vertices), 1)))
    assert mesh.normals and mesh.VertexColors.rows[0] == (1, 2, 3)
    assert mesh.Vertices[0].X != vertices[0, 0], "the stand-in has the trap"
    back, corners = inside.mesh_to_arrays(mesh)
    assert back.tobytes() == vertices.tobytes() and np.array_equal(corners[:, :3], faces) and np.array_equal(corners[:, 3], faces[:, 2])


def test_geometry_on_a_canvas_becomes_a_problem():
    vertices, faces = far_grid()
    mesh = inside.mesh_from_arrays(vertices, faces)
    model = inside.problem_from_rhino(
        mesh,
        supports=[Point3d(*vertices[v]) for v in corners_of(N)],
        creases=[Curve(vertices[row(N, 2)]), Curve(vertices[row(N, 4)], exact=False)],
        targets=[(Point3d(*(vertices[0] + [0.1, 0.1, 0])), 0.25)],
    )
    solved = CGCMesh.from_problem(model.checked())
    assert isinstance(solved, CGCMesh)
    assert solved.supports() == sorted(corners_of(N)) and len(solved.regions()) == 3 and solved.region_target(0) == 0.25
    assert solved.arrays()[0].tobytes() == vertices.tobytes()


def test_a_single_precision_mesh_still_meets_its_points():
    vertices, faces = far_grid()
    mesh = Mesh()
    for point in vertices.tolist():
        mesh.Vertices.Add(*point)
    for face in faces.tolist():
        mesh.Faces.AddFace(*face)
    model = inside.problem_from_rhino(mesh, [Point3d(*vertices[0])], tolerance=1e-9)
    assert model.problem.supports.tolist() == [0] and any("seven digits" in note for note in model.notes)
    far = inside.problem_from_rhino(mesh, [Point3d(0.0, 0.0, 0.0)])
    assert "point 0 is up to 1000" in far.diagnostics[0]
