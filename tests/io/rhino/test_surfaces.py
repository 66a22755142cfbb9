"""Surfaces without a mesh: spheres, cylinders, boxes, trimmed planes, extrusions, NURBS and blocks, meshed evenly."""

from __future__ import annotations

import math
import tracemalloc

import numpy as np
import pytest
import rhino3dm

from compas_cgc import CGCMesh
from compas_cgc.discrete import edge_faces
from compas_cgc.discrete import face_areas
from compas_cgc.discrete.nurbs import NurbsPatch
from compas_cgc.errors import FileError
from compas_cgc.errors import MeshError
from compas_cgc.io.rhino import read_3dm
from compas_cgc.io.rhino.curves import EDGE_ACCURACY
from compas_cgc.io.rhino.curves import curve_points
from compas_cgc.io.rhino.nurbs import nurbs_surface
from compas_cgc.io.rhino.parametric import ParametricSurface
from compas_cgc.meshing import boundary_loops
from compas_cgc.meshing.polyline import nearest_on_polyline
from compas_cgc.meshing.surface_mesh import _apart
from compas_cgc.model.checks import check

pytest.importorskip("compas_cgal")
pytest.importorskip("shapely")


def place(x, y, z=0.0):
    return rhino3dm.Point3d(x, y, z)


def box(size=(4.0, 3.0, 2.0)):
    return rhino3dm.Brep.CreateFromBox(rhino3dm.Box(rhino3dm.BoundingBox(place(0, 0, 0), place(*size))))


def cylinder():
    return rhino3dm.Brep.CreateFromCylinder(rhino3dm.Cylinder(rhino3dm.Circle(place(0, 0), 2.0), 3.0), False, False)


def sphere():
    return rhino3dm.Brep.CreateFromSphere(rhino3dm.Sphere(place(1, 2, 3), 2.0))


def disc():
    return rhino3dm.Brep.CreateTrimmedPlane(rhino3dm.Plane.WorldXY(), rhino3dm.Circle(place(0, 0), 2.0).ToNurbsCurve())


def saddle():
    """A bilinear patch, whose area is known by quadrature."""
    one = rhino3dm.LineCurve(place(0, 0, 0), place(4, 0, 1))
    other = rhino3dm.LineCurve(place(0, 4, 1), place(4, 4, 0))
    return rhino3dm.NurbsSurface.CreateRuledSurface(one, other)


def extrusion():
    corners = [place(0, 0), place(3, 0), place(3, 2), place(0, 2), place(0, 0)]
    return rhino3dm.Extrusion.Create(rhino3dm.PolylineCurve(corners), 1.5, True)


def saved(tmp_path, geometry):
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Meters
    model.Settings.ModelAbsoluteTolerance = 0.001
    if isinstance(geometry, rhino3dm.Brep):
        model.Objects.AddBrep(geometry)
    elif isinstance(geometry, rhino3dm.Extrusion):
        model.Objects.AddExtrusion(geometry)
    else:
        model.Objects.AddSurface(geometry)
    path = tmp_path / "a.3dm"
    model.Write(str(path), 7)
    return path


def smallest_angles(V, F):
    corners = V[F]
    angles = []
    for k in range(3):
        a, b = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
        angles.append(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.einsum("ij,ij->i", a, b)))
    return np.degrees(np.min(angles, axis=0))


SADDLE = (
    sum(
        math.sqrt(1 + (1 - 2 * u) ** 2 / 16 + (1 - 2 * v) ** 2 / 16)
        for u in np.linspace(0.005, 0.995, 100)
        for v in np.linspace(0.005, 0.995, 100)
    )
    * 16
    / 1e4
)
CASES = {
    "box": (box, 2 * (12 + 8 + 6), 0, 12),
    "cylinder": (cylinder, 12 * math.pi, 2, 0),
    "sphere": (sphere, 16 * math.pi, 0, 0),
    "disc": (disc, 4 * math.pi, 1, 0),
    "saddle": (saddle, SADDLE, 1, 0),
    "extrusion": (extrusion, 2 * 6 + 10 * 1.5, 0, 12),
}


@pytest.mark.parametrize("name", CASES)
def test_a_surface_is_meshed_evenly_and_its_sharp_joints_are_creases(tmp_path, name):
    make, area, loops, joints = CASES[name]
    h = 0.4
    model = read_3dm(saved(tmp_path, make()), edge_length=h)
    V, F = model.problem.vertices, model.problem.faces
    # A smooth surface lacks the area between it and its facets.
    assert face_areas(V, F).sum() == pytest.approx(area, rel=0.02)
    assert len(boundary_loops(F)) == loops
    edges = edge_faces(F)
    lengths = np.linalg.norm(V[edges[:, 0]] - V[edges[:, 1]], axis=1)
    assert 0.8 * h <= np.median(lengths) <= 1.25 * h and lengths.max() <= 2.1 * h
    angles = smallest_angles(V, F)
    assert angles.min() >= 15 and np.percentile(angles, 5) >= 30
    assert any("meshed with edges of about 0.4 m, within" in note for note in model.notes)
    assert (f"{joints} sharp joints" in " ".join(model.notes)) == (joints > 0)
    assert bool(len(model.problem.creases)) == (joints > 0)
    if joints:
        sharp = model.problem.creases
        along = np.linalg.norm(V[sharp[:, 0]] - V[sharp[:, 1]], axis=1).sum()
        assert along == pytest.approx({"box": 36.0, "extrusion": 26.0}[name])
    assert not [said for said in check(model.problem.with_targets(0.01)) if said.fatal and "support" not in said]


def folded(heights):
    """Return a surface of flat pieces over a grid of squares of 3 by 3, with kinks between."""
    rows, columns = np.shape(heights)
    surface = rhino3dm.NurbsSurface.Create(3, False, 2, 2, rows, columns)
    for i in range(rows):
        for j in range(columns):
            surface.Points[i, j] = rhino3dm.Point4d(3.0 * i, 3.0 * j, heights[i][j], 1.0)
    for knots, count in ((surface.KnotsU, rows), (surface.KnotsV, columns)):
        for k in range(count):
            knots[k] = float(k)
    return surface


@pytest.mark.parametrize(
    "heights, folds, regions, length",
    [
        ([[0, 0], [2, 2], [2, 2], [0, 0]], 2, 3, 6.0),
        ([[0, 0, 0], [2, 3, 2], [0, 0, 0]], 4, 4, 4 * 3.0),
        ([[0, 0], [0.3, 0.3], [0, 0]], 1, 2, 3.0),
        ([[0, 0, 0, 0], [0, 2, 2, 0], [0, 2, 2, 0], [0, 0, 0, 0]], 12, 9, 12 * 3.0),
        ([[0, 0], [0.1, 0.1], [0, 0]], 0, 1, 0.0),
    ],
    ids=["two folds", "folds that cross", "less than an edge's corner", "none at the edge", "all but flat"],
)
def test_a_kink_inside_a_face_is_a_crease(tmp_path, heights, folds, regions, length):
    model = read_3dm(saved(tmp_path, folded(heights)), edge_length=0.5)
    V, F, sharp = model.problem.vertices, model.problem.faces, model.problem.creases
    said = f"{folds} sharp joints" if folds > 1 else "a sharp joint"
    assert any(said in note for note in model.notes) == (folds > 0) and model.problem.regions().max() + 1 == regions
    plan = np.linalg.norm((V[sharp[:, 0]] - V[sharp[:, 1]])[:, :2], axis=1).sum()
    assert plan == pytest.approx(length)
    # The vertices of creases lie on the lines between the squares.
    on = V[np.unique(sharp)][:, :2]
    assert not len(on) or np.abs(on / 3.0 - np.round(on / 3.0)).min(axis=1).max() < 1e-9
    assert smallest_angles(V, F).min() >= 20
    mesh = CGCMesh.from_surface(folded(heights), 0.5)
    assert len(mesh.regions()) == regions and len(mesh.crease_edges()) == len(sharp)
    assert smallest_angles(*mesh.arrays()).min() >= 20


@pytest.mark.parametrize("end", [2.0, 0.0])
def test_an_edge_with_a_point_on_a_kink_crosses_it_once(end):
    surface = ParametricSurface(folded([[0, 0], [2, 2], [0, 0]]))
    line = surface.at(np.array([[2.0 - end, 0.5], [1.0, 0.5], [end, 0.5]]))
    assert surface.crossings(line, 0.01) == pytest.approx([math.sqrt(13.0)])


def spline(heights, knots, span=6.0):
    """Return a cubic barrel over a strip, with control points that may lie on each other."""
    rows = len(heights)
    surface = rhino3dm.NurbsSurface.Create(3, False, 4, 2, rows, 2)
    for i, (x, z) in enumerate(heights):
        for j in range(2):
            surface.Points[i, j] = rhino3dm.Point4d(x, span * j, z, 1.0)
    for k, knot in enumerate(knots):
        surface.KnotsU[k] = knot
    surface.KnotsV[0], surface.KnotsV[1] = 0.0, 1.0
    return surface


GABLE = [(0, 0), (1, 0.5), (2, 1.2), (3, 2), (4, 1.2), (5, 0.5), (6, 0)]


@pytest.mark.parametrize(
    "points, knots, regions",
    [
        (GABLE, [0, 0, 0, 1, 1, 1, 2, 2, 2], 2),
        (GABLE[:4] + 2 * GABLE[3:4] + GABLE[4:], [0, 0, 0, 1, 2, 3, 4, 5, 6, 6, 6], 2),
        (GABLE, [0, 0, 0, 1, 2, 3, 4, 4, 4], 1),
    ],
    ids=["a knot of full multiplicity", "control points on each other", "smooth"],
)
def test_a_spline_has_creases_at_the_knots_where_it_bends_sharply(points, knots, regions):
    mesh = CGCMesh.from_surface(spline(points, knots), 0.5)
    assert len(mesh.regions()) == regions
    ridge = {vertex for edge in mesh.crease_edges() for vertex in edge}
    assert all(mesh.vertex_coordinates(vertex)[::2] == pytest.approx([3.0, 2.0], abs=1e-6) for vertex in ridge)


def tube():
    """Return a surface of four walls that closes at a corner."""
    surface = rhino3dm.NurbsSurface.Create(3, False, 2, 2, 5, 2)
    for i, (x, y) in enumerate([(0, 0), (3, 0), (3, 3), (0, 3), (0, 0)]):
        for j in range(2):
            surface.Points[i, j] = rhino3dm.Point4d(x, y, 3.0 * j, 1.0)
        surface.KnotsU[i] = float(i)
    surface.KnotsV[0], surface.KnotsV[1] = 0.0, 1.0
    return surface


@pytest.mark.parametrize("make, regions", [(tube, 4), (box, 6), (extrusion, 6), (cylinder, 1)])
def test_joints_and_seams_of_surfaces_and_breps_are_creases(tmp_path, make, regions):
    mesh = CGCMesh.from_surface(make(), 0.5)
    assert len(mesh.regions()) == regions
    assert read_3dm(saved(tmp_path, make()), edge_length=0.5).problem.regions().max() + 1 == regions


def test_a_corner_of_the_side_of_a_surface_is_a_vertex():
    surface = folded([[0, 0], [0, 0], [0, 0]])
    surface.Points[1, 0] = rhino3dm.Point4d(3.0, 1.0, 0.0, 1.0)
    mesh = CGCMesh.from_surface(surface, 0.5)
    V, F = mesh.arrays()
    assert np.linalg.norm(V - [3, 1, 0], axis=1).min() == 0.0 and len(mesh.regions()) == 1
    assert face_areas(V, F).sum() == pytest.approx(6 * 3 - 3)


def test_what_is_no_surface_is_named():
    with pytest.raises(MeshError, match="a str is not a surface"):
        CGCMesh.from_surface("roof", 0.5)


def test_vertices_lie_on_the_surface_within_what_is_said(tmp_path):
    model = read_3dm(saved(tmp_path, sphere()), edge_length=0.5)
    radius = np.linalg.norm(model.problem.vertices - [1, 2, 3], axis=1)
    assert np.abs(radius - 2).max() < 2e-3
    note = next(note for note in model.notes if "within" in note)
    said = float(note.split("within ")[1].split()[0])
    middle = np.linalg.norm(model.problem.vertices[model.problem.faces].mean(axis=1) - [1, 2, 3], axis=1)
    assert 0.5 * said <= np.abs(middle - 2).max() <= 1.5 * said


def test_without_an_edge_length_one_is_taken_that_fits_the_size(tmp_path):
    model = read_3dm(saved(tmp_path, saddle()))
    assert 200 < len(model.problem.vertices) < 2000


def test_a_block_is_read_where_its_instances_put_it(tmp_path):
    model = rhino3dm.File3dm()
    attributes = rhino3dm.ObjectAttributes()
    index = model.InstanceDefinitions.Add("panel", "", "", "", place(0, 0), (saddle(),), (attributes,))
    block = model.InstanceDefinitions[index]
    layer = rhino3dm.Layer()
    layer.Name = "Panels"
    model.Layers.Add(layer)
    move = rhino3dm.Transform.Translation(10, 20, 30)
    model.Objects.AddInstanceObject(rhino3dm.InstanceReference(block.Id, move))
    path = tmp_path / "a.3dm"
    model.Write(str(path), 7)
    V = read_3dm(path, edge_length=0.5).problem.vertices
    assert np.allclose(V.min(axis=0), [10, 20, 30]) and np.allclose(V.max(axis=0), [14, 24, 31])


def test_a_surface_gets_edges_along_drawn_curved_creases(tmp_path):
    path = tmp_path / "facade.3dm"
    archive = rhino3dm.File3dm()
    layers = {name: archive.Layers.AddLayer(name, (0, 0, 0, 255)) for name in ("CGC::Mesh", "CGC::Creases")}
    archive.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Meters
    control = np.array([[[x, y, 0.4 * y * y / 9 - 0.3 * (x - 6) ** 2 / 36, 1.0] for y in (0.0, 3.0, 6.0)] for x in (0.0, 4.0, 8.0, 12.0)])
    knots = (np.array([0, 0, 0, 0, 1, 1, 1, 1.0]), np.array([0, 0, 0, 1, 1, 1.0]))
    surface = NurbsPatch(control, knots, (3, 2))
    drawn = []
    for start, bend in ((0.33, 0.07), (0.66, -0.06)):
        v = np.linspace(0.0, 1.0, 60)
        points = np.array([surface.at(np.array([start + bend * np.sin(np.pi * t)]), np.array([t]))[0, 0] for t in v])
        drawn.append(points)
    for name, geometry in [
        ("CGC::Mesh", nurbs_surface(surface)),
        *(("CGC::Creases", rhino3dm.PolylineCurve(rhino3dm.Point3dList([rhino3dm.Point3d(*p) for p in own.tolist()]))) for own in drawn),
    ]:
        attributes = rhino3dm.ObjectAttributes()
        attributes.LayerIndex = layers[name]
        archive.Objects.Add(geometry, attributes)
    assert archive.Write(str(path), 7)
    found = read_3dm(path, edge_length=0.4)
    problem = found.problem
    paths = problem.crease_paths()
    assert len(paths) == 2 and problem.regions().max() == 2 and not any("nearest path" in note for note in found.notes)
    for line in (problem.vertices[own] for own in paths):
        gaps = [nearest_on_polyline(line, own)[0] for own in drawn]
        assert min(gap.max() for gap in gaps) < 1e-3
        middles = 0.5 * (line[1:] + line[:-1])
        assert min(nearest_on_polyline(middles, own)[0].max() for own in drawn) < 5e-3
    assert smallest_angles(problem.vertices, problem.faces).min() > 25.0


def test_a_curve_is_sampled_no_finer_than_what_matters():
    """Some drawings have a tolerance of 0, or far below the size of a grain."""
    circle = rhino3dm.Circle(place(0, 0), 50.0).ToNurbsCurve()
    points = curve_points(circle, 0.0, EDGE_ACCURACY)
    middles = 0.5 * (points[1:] + points[:-1])
    assert len(points) < 10_000 and 50.0 - np.linalg.norm(middles, axis=1).min() < 142.0 * EDGE_ACCURACY
    assert len(curve_points(circle, 1e-2, EDGE_ACCURACY)) == len(curve_points(circle, 1e-2)) < 0.2 * len(points)


def test_a_crease_off_the_surface_costs_little(tmp_path, monkeypatch):
    model, pulled = rhino3dm.File3dm(), []
    layers = {name: model.Layers.AddLayer(name, (0, 0, 0, 255)) for name in ("CGC::Mesh", "CGC::Creases")}
    above = rhino3dm.NurbsCurve.Create(False, 3, [place(x, x * x / 4, 2.0) for x in range(5)])
    model.Settings.ModelAbsoluteTolerance = 0.0
    for name, geometry in (("CGC::Mesh", saddle()), ("CGC::Creases", above)):
        attributes = rhino3dm.ObjectAttributes()
        attributes.LayerIndex = layers[name]
        model.Objects.Add(geometry, attributes)
    assert model.Write(str(tmp_path / "above.3dm"), 7)
    once = ParametricSurface.pulled_back
    monkeypatch.setattr(ParametricSurface, "pulled_back", lambda self, line, reach: pulled.append(len(line)) or once(self, line, reach))
    found = read_3dm(tmp_path / "above.3dm", edge_length=0.5)
    assert min(pulled) < 20 and sum(pulled) < 500
    assert any("does not lie on the mesh" in str(each) or "off the mesh" in str(each) for each in [*found.diagnostics, *found.notes])


def test_a_squeezed_surface_takes_no_memory_for_pairs_of_points():
    random = np.random.default_rng(0)
    spots = np.concatenate([1e-4 * random.normal(size=(4000, 3)), random.normal(size=(500, 3))])
    tracemalloc.start()
    kept = _apart(spots, np.array([[9.0, 9.0, 9.0]]), 0.2)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    distances = np.linalg.norm(spots[kept][:, None] - spots[kept], axis=2) + np.eye(len(kept))
    assert distances.min() >= 0.2 and np.linalg.norm(spots[:, None] - spots[kept], axis=2).min(axis=1).max() <= 0.2
    assert peak < 10e6


def test_damaged_coordinates_are_refused(tmp_path):
    model = rhino3dm.File3dm()
    attributes = rhino3dm.ObjectAttributes()
    attributes.LayerIndex = model.Layers.AddLayer("CGC::Mesh", (0, 0, 0, 255))
    damaged = saddle()
    corner = damaged.Points[0, 0]
    corner.Z = 1e149
    damaged.Points[0, 0] = corner
    model.Objects.Add(damaged, attributes)
    assert model.Write(str(tmp_path / "damaged.3dm"), 7)
    with pytest.raises(FileError, match=r"e\+14\d large; its coordinates are damaged"):
        read_3dm(tmp_path / "damaged.3dm")


@pytest.mark.parametrize("far", [1e7, 1e11])
def test_a_smooth_surface_far_from_the_origin_gets_no_joints_and_the_mesh_of_one_at_the_origin(tmp_path, far):
    def dome():
        made = rhino3dm.NurbsSurface.Create(3, False, 4, 4, 9, 9)
        for i in range(9):
            for j in range(9):
                made.Points[i, j] = rhino3dm.Point4d(i, j, 0.1 * (i * (8 - i) + j * (8 - j)), 1.0)
        for knots in (made.KnotsU, made.KnotsV):
            knots.CreateUniformKnots(1.0)
        return made

    near = read_3dm(saved(tmp_path, dome()), edge_length=0.5)
    moved = dome()
    moved.Transform(rhino3dm.Transform.Translation(rhino3dm.Vector3d(far, -far, 0.0)))
    found = read_3dm(saved(tmp_path, moved), edge_length=0.5)
    assert not len(found.problem.creases) and np.array_equal(found.problem.faces, near.problem.faces)
    assert np.abs(found.problem.vertices - near.problem.vertices - [far, -far, 0.0]).max() < 1e-15 * far + 1e-9
