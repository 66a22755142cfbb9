"""A Rhino file comes in: the layers of the convention, and files without any."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
import rhino3dm

from compas_cgc import CGCMesh
from compas_cgc.errors import FileError
from compas_cgc.errors import ProblemError
from compas_cgc.io.rhino import describe
from compas_cgc.io.rhino import read_3dm
from compas_cgc.io.rhino import write_problem
from compas_cgc.model.constraints import OnCurve
from compas_cgc.model.problem import FIXED

from ...support.rhino_models import ORIGINS
from ...support.rhino_models import Sketch
from ...support.rhino_models import corners_of
from ...support.rhino_models import place_of
from ...support.rhino_models import point3d
from ...support.rhino_models import quads
from ...support.rhino_models import row
from ...support.shapes import grid

N = 9


@pytest.fixture
def sketch():
    return Sketch()


def plan(width=float(N), origin=(0.0, 0.0, 0.0)):
    vertices, faces = quads(N, width)
    return vertices + np.array(origin), faces


def mesh_of(model):
    """Return the mesh of what was read, if all of it could be used."""
    return CGCMesh.from_problem(model.checked())


def said(model, *words):
    """Tell whether a note has all of the words."""
    return any(all(word in note for word in words) for note in model.notes)


# ----------------------------------------------------------------------
# Without layers
# ----------------------------------------------------------------------


@pytest.mark.parametrize("origin", ORIGINS)
@pytest.mark.parametrize("units", ["Meters", "Millimeters"])
def test_a_file_without_layers_mesh_points_and_curves(tmp_path, origin, units):
    sketch = Sketch(units)
    vertices, faces = plan(origin=origin)
    sketch.mesh(vertices, faces)
    sketch.points(vertices[corners_of(N)[:2]])
    sketch.cloud(vertices[corners_of(N)[2:]])
    sketch.curve(vertices[row(N, 3)][[0, -1]])
    sketch.dot("K=0,03", vertices[0] + [0.5, 0.5, 0])
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    assert model.problem.vertices.tobytes() == vertices.tobytes()
    assert model.problem.supports.tolist() == sorted(corners_of(N)) and model.problem.crease_paths() == [row(N, 3)]
    assert model.problem.drawing.units == units and model.problem.drawing.tolerance == 1e-3 and not model.diagnostics
    mesh = mesh_of(model)
    assert mesh.attributes["units"] == units and [mesh.region_target(r) for r in range(2)] == [0.03, None]
    assert said(model, "region 1", "no target")


def test_of_several_meshes_the_first_is_taken_and_the_others_named(sketch, tmp_path):
    sketch.mesh(*plan())
    sketch.mesh(*plan(3.0))
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    assert said(model, place_of(plan()[0]), "1 more ignored", "CGC::Mesh")
    assert said(model, "no support")


def test_hidden_things_are_left_out(sketch, tmp_path):
    sketch.mesh(*plan(3.0), visible=False)
    sketch.mesh(*plan())
    sketch.points([[50, 50, 50]], visible=False)
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    assert np.ptp(model.problem.vertices[:, 0]) == N and not model.diagnostics and said(model, "2 hidden")


WRITTEN = [
    "CGC Result::Regions",
    "CGC Rationalised::Seams",
    "CGC::NURBS",
    "CGC Curves",
    "CGC Membrane",
    "CGC Moulds",
    "CGC Patterns",
    "CGC Quads",
]


@pytest.mark.parametrize("layer", WRITTEN)
def test_what_was_made_of_a_drawing_before_is_no_part_of_it(sketch, tmp_path, layer):
    vertices, faces = plan()
    sketch.mesh(*plan(3.0), f"{layer}::Surface")
    sketch.points(vertices[row(N, 4)], f"{layer}::Nodes")
    sketch.curve(vertices[row(N, 6)], layer)
    sketch.dot("K = 0.5", vertices[50], layer)
    sketch.mesh(vertices, faces, "Roof")
    sketch.points(vertices[corners_of(N)], "Roof")
    sketch.curve(vertices[row(N, 3)], "Roof")
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    assert len(model.problem.vertices) == len(vertices) and model.problem.supports.tolist() == sorted(corners_of(N))
    assert model.problem.crease_paths() == [row(N, 3)] and np.isnan(model.problem.targets).all()
    own = read_3dm(tmp_path / "a.3dm", layers={"mesh": f"{layer}::Surface"})
    assert np.ptp(own.problem.vertices[:, 0]) == 3.0


# ----------------------------------------------------------------------
# The convention
# ----------------------------------------------------------------------


def test_the_layers_of_the_convention_in_capitals_or_not(sketch, tmp_path):
    vertices, faces = plan()
    sketch.mesh(vertices, faces, "cgc::mesh::roof")
    sketch.points(vertices[corners_of(N)], "cgc::SUPPORTS")
    sketch.curve(vertices[row(N, 3)], "cgc::Creases::main", {"S": "0.5", "E": "4"})
    sketch.dot("0.02", [0.4, 4, 0], "cgc::Targets")
    sketch.points([[6, 4, 0]], "cgc::Targets", {"k": "-0.5"})
    sketch.curve(vertices[row(N, 6)], "cgc::Constraints")
    sketch.curve([[0, 0, 9], [9, 9, 9]], "Sketches")
    sketch.points([[4, 4, 4]])
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    assert not model.diagnostics and len(model.problem.crease_paths()) == 1 and len(model.problem.supports) == 4
    mesh = mesh_of(model)
    assert [mesh.region_target(r) for r in range(2)] == [0.02, -0.5]
    assert mesh.vertex_s(row(N, 3)[4]) == 0.5 and mesh.vertex_e(row(N, 3)[4]) == 4 and mesh.vertex_s(0) is None
    (constraint,) = mesh.goals()
    assert isinstance(constraint, OnCurve) and constraint.vertices == row(N, 6) and not constraint.closed
    assert said(model, "1 curve, 1 point", "ignored")


def test_constraints_besides_the_curvature(sketch, tmp_path):
    vertices, faces = plan()
    sketch.mesh(vertices, faces, "CGC::Mesh")
    ring = [vertices[v] for v in (22, 24, 44, 42, 22)]
    sketch.curve(ring, "CGC::Constraints")
    sketch.curve(vertices[row(N, 7)], "CGC::Constraints", {"keep": "yes"})
    sketch.points([vertices[55] + [0, 0, 3.5]], "CGC::Constraints")
    sketch.points([vertices[57]], "CGC::Constraints", {"Keep": "yes"})
    sketch.points([vertices[55] + [0.4, 0, 3.5]], "CGC::Constraints")
    sketch.curve([[0, 0, 5], [9, 9, 5]], "CGC::Constraints")
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    places = place_of([vertices[55] + [0.4, 0, 3.5]]), place_of([[0, 0, 5], [9, 9, 5]])
    assert [place in problem for place, problem in zip(places, model.diagnostics)] == [True, True]
    mesh = CGCMesh.from_problem(model.problem)
    write_problem(tmp_path / "b.3dm", mesh)
    for again in (mesh, mesh_of(read_3dm(tmp_path / "b.3dm"))):
        found = {}
        for constraint in again.goals():
            found.setdefault(type(constraint).__name__, []).append(constraint)
        (curve,), (height,) = found["OnCurve"], found["Height"]
        assert curve.closed and len(curve.vertices) == 8 and (height.vertices, height.height) == ([55], 3.5)
        assert {v for held in found["Fixed"] for v in held.vertices} == {57, *row(N, 7)}


def test_the_points_of_a_cloud_are_one_constraint_for_each_height(sketch, tmp_path):
    vertices, faces = plan()
    sketch.mesh(vertices, faces, "CGC::Mesh")
    sketch.cloud(vertices[[55, 33, 57]] + [[0, 0, 3.5], [0, 0, 2], [0, 0, 3.5]], "CGC::Constraints")
    high, low = read_3dm(sketch.save(tmp_path / "a.3dm")).checked().goals
    assert (high.vertices, high.height) == ([55, 57], 3.5) and (low.vertices, low.height) == ([33], 2.0)


def test_a_constraint_that_cannot_be_used_is_named(sketch, tmp_path):
    vertices, faces = plan()
    broken = {
        "not JSON": "cannot be used",
        '{"vertices": 100, "goals": [{"kind": "magic"}]}': "a constraint must be an object with a 'kind'",
        '{"vertices": 100, "goals": [{"kind": "held", "vertices": [100]}]}': "names vertex 100",
        '{"vertices": 7, "goals": []}': "a mesh with 7 vertices, but this mesh has 100",
        "[]": "not a list of goals",
    }
    for text, words in broken.items():
        sketch = Sketch()
        sketch.mesh(vertices, faces, "CGC::Mesh", {"cgc goals": text})
        sketch.points([[np.nan, 0, 0]], "CGC::Constraints")
        model = read_3dm(sketch.save(tmp_path / "a.3dm"))
        about_point, about_text = model.diagnostics
        assert "constraint point" in about_point and "'CGC::Constraints'" in about_point and "delete it" in about_point
        assert place_of(vertices) in about_text and "'cgc goals'" in about_text and words in about_text and "delete the text" in about_text
        with pytest.raises(ProblemError):
            model.checked()


def test_values_and_constraints_in_texts_follow_vertices_that_are_renumbered(sketch, tmp_path):
    vertices, faces = plan()
    # Two vertices more, at the front: one of no face, one at the place of the first.
    loose = np.vstack([[50.0, 50.0, 50.0], vertices[:1], vertices])
    targets = [None, None, *([0.5] * 50), *([0.25] * 50)]
    constraints = [{"kind": "near", "vertices": [2, 57], "weight": 3.0}]
    text = {
        "cgc vertices": json.dumps({"target": targets}),
        "cgc goals": json.dumps({"vertices": 102, "goals": constraints}),
    }
    sketch.mesh(loose, faces + 2, "CGC::Mesh", text)
    problem = read_3dm(sketch.save(tmp_path / "a.3dm")).checked()
    place = {tuple(p): v for v, p in enumerate(problem.vertices.tolist())}
    assert problem.targets[place[tuple(vertices[7])]] == 0.5 and problem.targets[place[tuple(vertices[60])]] == 0.25
    (near,) = problem.goals
    assert sorted(near.vertices) == sorted(place[tuple(vertices[v])] for v in (0, 55)) and near.weight == 3.0


@pytest.mark.parametrize(
    "units, short", [("Millimeters", "mm"), ("Centimeters", "cm"), ("Meters", "m"), ("Kilometers", "km"), ("Inches", "in")]
)
def test_lengths_are_said_in_the_units_of_the_file(tmp_path, units, short):
    sketch = Sketch(units)
    vertices, faces = plan()
    sketch.mesh(vertices, faces, "CGC::Mesh")
    sketch.points(vertices[:1] + [0, 0, 0.25], "CGC::Supports")
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    assert f"is up to 0.25 {short} away" in model.diagnostics[0] and f"tolerance of 0.001 {short})" in model.diagnostics[0]
    assert describe(model)[0].startswith(f"a: {units}, tolerance 0.001 {short}\n")


def test_targets_on_the_mesh_its_layer_and_in_dots(sketch, tmp_path):
    vertices, faces = plan()
    sketch.mesh(vertices, faces, "CGC::Mesh", {"K": "0.01"})
    sketch.curve(vertices[row(N, 3)], "CGC::Creases")
    sketch.dot("roof over the hall\nK = 4e-2", [6, 4, 80], "CGC::Targets")
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    mesh = mesh_of(model)
    assert [mesh.region_target(r) for r in range(2)] == [0.01, 0.04], "a dot goes before the mesh"

    sketch = Sketch()
    sketch.mesh(vertices, faces, "CGC::Mesh")
    sketch.file.Layers[sketch.on("CGC::Mesh").LayerIndex].SetUserString("K", "0.07")
    assert mesh_of(read_3dm(sketch.save(tmp_path / "b.3dm"))).region_target(0) == 0.07


def test_several_meshes_on_the_layer_become_one(sketch, tmp_path):
    vertices, faces = plan()
    sketch.mesh(vertices, faces, "CGC::Mesh", {"K": "1"})
    sketch.mesh(vertices + [0, N, 0], faces[:, ::-1], "CGC::Mesh", {"K": "2"})
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    assert len(model.problem.vertices) == (N + 1) * (2 * N + 1) and said(model, "1 piece") and said(model, "turned over")


def test_supports_along_curves(sketch, tmp_path):
    vertices, faces = plan()
    sketch.mesh(vertices, faces, "CGC::Mesh")
    rim = [vertices[v] for v in (0, N, (N + 1) ** 2 - 1, N * (N + 1), 0)]
    sketch.curve(rim, "CGC::Supports")
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    assert len(model.problem.supports) == 4 * N and not model.diagnostics


def test_own_layer_names_by_argument_and_in_a_file_beside(sketch, tmp_path):
    vertices, faces = plan()
    sketch.mesh(vertices, faces, "Roof::Shell")
    sketch.points(vertices[corners_of(N)[:1]], "Columns")
    sketch.points(vertices[corners_of(N)[1:]], "Walls")
    sketch.points([[3, 3, 3]], "Furniture")
    path = sketch.save(tmp_path / "a.3dm")
    names = {"mesh": "Roof", "supports": ["Columns", "Walls"]}
    assert len(read_3dm(path, layers=names).problem.supports) == 4
    path.with_suffix(".toml").write_text('[layers]\nmesh = "Roof"\nsupports = ["Columns", "Walls"]\n', encoding="utf-8")
    assert len(read_3dm(path).problem.supports) == 4
    assert len(read_3dm(path, layers={"supports": "Columns"}).problem.supports) == 1, "the argument goes before the file"
    for text, words in (
        ('[layers]\nroof = "A"', "unknown role 'roof'"),
        ("[layers", "TOML"),
        ("[layers]\nmesh = 3", "not 3"),
        ("layers = 3", "table"),
    ):
        path.with_suffix(".toml").write_text(text, encoding="utf-8")
        with pytest.raises(FileError, match=words):
            read_3dm(path)


# ----------------------------------------------------------------------
# Meshes as Rhino makes them
# ----------------------------------------------------------------------


def test_unwelded_mixed_and_single_precision_far_from_the_origin(sketch, tmp_path):
    vertices, faces = plan(origin=(5000.1, 5000.0, 0.0))
    loose = vertices[faces].reshape(-1, 3)
    own = np.arange(len(loose)).reshape(-1, 4).tolist()
    own[7] = own[7][::-1]
    own[9:10] = [own[9][:3], [own[9][2], own[9][3], own[9][0]]]
    sketch.mesh(loose, own, single=True)
    sketch.points(vertices[corners_of(N)])
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    assert len(model.problem.vertices) == (N + 1) ** 2 and len(model.problem.faces) == 2 * N * N and len(model.problem.supports) == 4
    for words in (["welded"], ["quads"], ["2 faces were turned"], [place_of(vertices), "seven digits", "far from the origin"]):
        assert said(model, *words), words
    (problem,) = mesh_of(model).check()
    assert problem.startswith("no target curvature is set; set one (mesh.set_target(K), or --target K); ")


def test_normals_that_point_down_are_said(sketch, tmp_path):
    vertices, faces = plan()
    sketch.mesh(vertices, faces[:, ::-1])
    assert said(read_3dm(sketch.save(tmp_path / "a.3dm")), "normals point down")


def test_a_brep_without_a_mesh_and_the_mesher_says_how_to_get_either(sketch, tmp_path, monkeypatch):
    box = rhino3dm.Brep.CreateFromBox(rhino3dm.Box(rhino3dm.BoundingBox(point3d((0, 0, 0)), point3d((1, 1, 1)))))
    sketch.file.Objects.AddBrep(box, sketch.on("CGC::Mesh"))
    monkeypatch.setitem(sys.modules, "shapely", None)
    with pytest.raises(FileError, match=r"Brep .* on layer 'CGC::Mesh' .*compas_cgc\[mesher\].*; run Rhino's command Mesh"):
        read_3dm(sketch.save(tmp_path / "a.3dm"))


MESHED_BREP = """
import os, sys, rhino3dm
box = rhino3dm.Brep.CreateFromBox(rhino3dm.Box(rhino3dm.BoundingBox(rhino3dm.Point3d(0, 0, 0), rhino3dm.Point3d(1, 1, 1))))
meshes = []
for i in range(len(box.Faces)):
    face, mesh = box.Faces[i], rhino3dm.Mesh()
    u, v = face.Domain(0), face.Domain(1)
    for a, b in ((u.T0, v.T0), (u.T1, v.T0), (u.T1, v.T1), (u.T0, v.T1)):
        p = face.PointAt(a, b)
        mesh.Vertices.Add(p.X, p.Y, p.Z)
    mesh.Faces.AddFace(0, 1, 2, 3)
    face.SetMesh(mesh, rhino3dm.MeshType.Render)
    meshes.append(mesh)
file = rhino3dm.File3dm()
file.Objects.AddBrep(box)
file.Write(sys.argv[1], 7)
os._exit(0)
"""


def test_a_brep_with_a_render_mesh_is_accepted(tmp_path):
    # In a process that ends at once: rhino3dm frees a mesh twice that was given to a Brep.
    path = tmp_path / "a.3dm"
    subprocess.run([sys.executable, "-c", MESHED_BREP, str(path)], check=True)
    model = read_3dm(path)
    assert len(model.problem.vertices) == 8 and len(model.problem.faces) == 12 and said(model, "is not a mesh")
    corners = model.problem.vertices[model.problem.faces]
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert abs(volume) == pytest.approx(1.0)


# ----------------------------------------------------------------------
# Curves of all kinds
# ----------------------------------------------------------------------


def bent(n=24, radius=10.0):
    """Return a sector of a ring whose middle row lies on an arc."""
    vertices, faces = grid(n, 1.0)
    angle, r = vertices[:, 0] * np.pi / 2, radius + 4 * (vertices[:, 1] - 0.5)
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), 0 * r]), faces


@pytest.mark.parametrize("kind", ["arc", "nurbs", "interpolated", "polycurve", "polyline"])
def test_a_curve_of_any_kind_along_a_bent_row_of_edges(sketch, tmp_path, kind):
    n, radius = 24, 10.0
    vertices, faces = bent(n, radius)
    path = [i * (n + 1) + n // 2 for i in range(n + 1)]
    middle, end = vertices[path[n // 2]], vertices[path[-1]]
    arc = rhino3dm.Arc(point3d(vertices[path[0]]), point3d(middle), point3d(end))
    if kind == "arc":
        curve = rhino3dm.NurbsCurve.CreateFromArc(arc)
        sketch.file.Objects.AddArc(arc)
    elif kind == "nurbs":
        curve = rhino3dm.NurbsCurve.CreateFromArc(arc)
    elif kind == "interpolated":
        # Straight between the vertices, with the parameter running unevenly.
        curve = rhino3dm.NurbsCurve.Create(False, 1, [point3d(vertices[v]) for v in path])
    elif kind == "polycurve":
        curve = rhino3dm.PolyCurve()
        half = rhino3dm.Arc(point3d(vertices[path[0]]), point3d(vertices[path[n // 4]]), point3d(middle))
        curve.Append(half)
        for a, b in zip(path[n // 2 : -1], path[n // 2 + 1 :]):
            curve.Append(rhino3dm.Line(point3d(vertices[a]), point3d(vertices[b])))
    else:
        curve = vertices[path]
    sketch.mesh(vertices, faces)
    if kind != "arc":
        sketch.curve(curve)
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    assert [sorted(found) for found in model.problem.crease_paths()] == [path] and not said(model, "does not follow")


def test_a_crease_that_does_not_follow_edges_is_traced_or_cut(sketch, tmp_path):
    sketch.mesh(*plan())
    circle = rhino3dm.Circle(point3d((4.6, 4.4, 0)), 2.7)
    name = "curve at (4.6, 4.4, 0)"
    sketch.curve(circle.ToNurbsCurve(), "Creases")
    path = sketch.save(tmp_path / "a.3dm")
    traced = read_3dm(path)
    assert said(traced, name, "'Creases'", "nearest path of edges", "of a mean edge")
    assert len(mesh_of(traced).regions()) == 2 and len(traced.problem.vertices) == (N + 1) ** 2
    cut = read_3dm(path, crease="split")
    assert said(cut, name, "was split along", "new vertices") and len(mesh_of(cut).regions()) == 2
    (loop,) = cut.problem.crease_paths()
    away = np.linalg.norm(cut.problem.vertices[loop] - [4.6, 4.4, 0], axis=1) - 2.7
    assert np.abs(away).max() < 1e-3
    with pytest.raises(ValueError, match="trace, split"):
        read_3dm(path, crease="bend")


def test_where_two_meshes_of_one_region_ask_for_different_curvatures_the_first_is_heard(sketch, tmp_path):
    vertices, faces = plan()
    sketch.mesh(vertices, faces, "CGC::Mesh", {"K": "0.01"})
    sketch.mesh(vertices + [N, 0, 0], faces, "CGC::Mesh", {"K": "0.02"})
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    assert len(mesh_of(model).regions()) == 1 and set(model.problem.targets[model.problem.asked]) == {0.01}
    for K in ("0.01", "0.02"):
        assert any(f"prescribes K = {K}" in note for note in model.notes), "both are said"


def test_a_crease_drawn_a_little_short_of_another_ends_on_it(sketch, tmp_path):
    """The vertex before the other one is nearer to the end of the curve, but would leave a gap between two regions."""
    vertices, faces = plan()
    sketch.mesh(vertices, faces)
    sketch.curve(vertices[row(N, 4)], "Creases")
    sketch.curve(np.array([[0, 2.9, 0], [1.7, 3.1, 0], [3.4, 3.1, 0]], float), "Creases")
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    # The first is in two parts: the second one meets it between its ends.
    assert len(model.problem.crease_paths()) == 3 and len(mesh_of(model).regions()) == 3


def test_a_support_stays_where_it_is_when_the_mesh_is_split_beside_it(sketch, tmp_path):
    vertices, faces = plan()
    sketch.mesh(vertices, faces)
    column = [3.0, 4.0, 0.0]
    sketch.points(np.array([column, *vertices[corners_of(N)]]), "Supports")
    sketch.curve(np.array([[-1, 4.07, 0], [N + 1, 4.07, 0]], float), "Creases")
    problem = read_3dm(sketch.save(tmp_path / "a.3dm"), crease="split").problem
    held = problem.vertices[problem.roles == FIXED].tolist()
    assert len(held) == 5 and column in held
    # Any other vertex as near to the curve is moved onto it.
    assert [5.0, 4.0, 0.0] not in problem.vertices.tolist()


def test_creases_that_cross_touch_the_boundary_and_close(sketch, tmp_path):
    vertices, faces = plan()
    sketch.mesh(vertices, faces)
    sketch.curve([[3, 0, 0], [3, 9, 0]])
    sketch.curve([[0, 6, 0], [9, 6, 0]])
    sketch.curve([[5, 2, 0], [7, 2, 0], [7, 4, 0], [5, 4, 0], [5, 2, 0]])
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    assert not model.diagnostics and len(mesh_of(model).regions()) == 5


def test_split_creases_cross_each_other(sketch, tmp_path):
    sketch.mesh(*plan())
    sketch.curve([[-1, 2.2, 0], [10, 6.7, 0]])
    sketch.curve([[2.3, -1, 0], [6.6, 10, 0]])
    sketch.points([[4, 4, 0]])
    model = read_3dm(sketch.save(tmp_path / "a.3dm"), crease="split")
    assert not model.diagnostics and len(mesh_of(model).regions()) == 4
    assert np.array_equal(model.problem.vertices[model.problem.supports[0]], [4, 4, 0]), "a support is not moved onto a crease"


# ----------------------------------------------------------------------
# What does not fit
# ----------------------------------------------------------------------


def test_everything_that_does_not_fit_is_named_with_place_layer_and_remedy(sketch, tmp_path):
    vertices, faces = plan()
    sketch.mesh(vertices, faces, "CGC::Mesh")
    sketch.points([vertices[3] + [0, 0, 0.25]], "CGC::Supports", name="mast")
    sketch.curve([[40, 0, 0], [50, 0, 0]], "CGC::Supports")
    sketch.curve([[0, 0, 30], [9, 9, 30]], "CGC::Creases")
    for words, place in (("high", [1, 1, 0]), ("K=1", [2, 2, 0]), ("K=2", [7, 7, 0])):
        sketch.dot(words, place, "CGC::Targets")
    far = f"point 'mast' {place_of([vertices[3] + [0, 0, 0.25]])}"
    loose, away = "curve at (45, 0, 0)", "curve at (4.5, 4.5, 30)"
    wordy, one, two = (f"text dot at ({x}, {x}, 0)" for x in (1, 2, 7))
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    problems = list(model.diagnostics)
    expected = {
        far: ["'CGC::Supports'", "0.25 m away", "snap"],
        loose: ["'CGC::Supports'", "a vertex of the mesh"],
        away: ["'CGC::Creases'", "does not lie on the mesh"],
        wordy: ["'CGC::Targets'", "write K=0.03"],
        two: [one, "same region", "delete one"],
    }
    for name, words in expected.items():
        (sentence,) = [problem for problem in problems if name in problem and not (name == one and two in problem)]
        assert all(word in sentence for word in words), sentence
    with pytest.raises(ProblemError) as refusal:
        mesh_of(model)
    assert refusal.value.problems == problems
    text, listed = describe(model)
    assert listed[: len(problems)] == problems and "1 region" in text and "tolerance 0.001 m" in text


@pytest.mark.parametrize(
    "vertices, faces, words",
    [
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [], "has no faces"),
        ([[0, 0, 0], [1, 0, 0], [0, np.nan, 0]], [[0, 1, 2]], "vertex 2 has a coordinate that is not finite"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 7]], "vertices that do not exist"),
        ([[0, 0, 0], [0, 0, 0], [0, 0, 0]], [[0, 1, 2]], "no face with three different corners"),
    ],
)
def test_meshes_that_are_none(sketch, tmp_path, vertices, faces, words):
    sketch.mesh(vertices, faces)
    path = sketch.save(tmp_path / "a.3dm")
    with pytest.raises(FileError, match=words) as refusal:
        read_3dm(path)
    assert str(path) in str(refusal.value) and ("mesh at (" in str(refusal.value) or "damaged" in str(refusal.value))


def test_a_file_without_a_mesh(sketch, tmp_path):
    sketch.points([[0, 0, 0]])
    with pytest.raises(FileError, match="the file has no mesh"):
        read_3dm(sketch.save(tmp_path / "a.3dm"))


def test_a_moebius_strip_is_read_and_the_check_says_what_it_is(sketch, tmp_path):
    angle = np.linspace(0, 2 * np.pi, 25)
    rows = [
        [(4 + w * np.cos(a / 2)) * np.cos(a), (4 + w * np.cos(a / 2)) * np.sin(a), w * np.sin(a / 2)] for a in angle for w in (-1, 0, 1)
    ]
    faces = [[3 * i + j, 3 * i + 3 + j, 3 * i + 4 + j, 3 * i + 1 + j] for i in range(24) for j in range(2)]
    sketch.mesh(rows, faces)
    model = read_3dm(sketch.save(tmp_path / "a.3dm"))
    assert any("not orientable" in problem for problem in mesh_of(model).check())
