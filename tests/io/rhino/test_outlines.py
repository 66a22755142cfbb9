"""A mesh from curves alone."""

from __future__ import annotations

import sys

import numpy as np
import pytest
import rhino3dm

from compas_cgc import CGCMesh
from compas_cgc.discrete import boundary_vertices
from compas_cgc.discrete import face_areas
from compas_cgc.errors import FileError
from compas_cgc.errors import MeshError
from compas_cgc.io.rhino import read_3dm
from compas_cgc.io.rhino.outlines import outlined
from compas_cgc.io.rhino.sketch import Drawn

from ...support.rhino_models import Sketch
from ...support.rhino_models import point3d

SQUARE = np.array([[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0], [0, 0, 0]], float)


@pytest.fixture
def mesher():
    pytest.importorskip("compas_cgal")
    pytest.importorskip("shapely")
    from compas_cgc.meshing.outline import mesh_from_outline

    return mesh_from_outline


def regular(made):
    """Return the part of the inner vertices that has valence 6, and the smallest angle in degrees."""
    faces = made.faces
    edges = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
    inner = ~boundary_vertices(made.vertices, faces)
    P = made.vertices[faces]
    sides = [P[:, (k + 1) % 3] - P[:, k] for k in range(3)]
    units = [side / np.linalg.norm(side, axis=1, keepdims=True) for side in sides]
    cosines = [-np.einsum("ij,ij->i", a, b) for a, b in zip(units, units[1:] + units[:1])]
    return np.mean(np.bincount(edges.ravel(), minlength=len(made.vertices))[inner] == 6), np.degrees(np.arccos(np.max(cosines)))


def test_a_square_with_crossing_creases_and_a_hole(mesher):
    angle = np.linspace(0, 2 * np.pi, 100)
    hole = np.column_stack([7.5 + np.cos(angle), 7.5 + np.sin(angle), 0 * angle])
    hole[-1] = hole[0]
    creases = [np.array([[-3, 4.1, 0], [13, 4.1, 0]], float), np.array([[3.2, 0, 0], [3.2, 10, 0]])]
    made = mesher(SQUARE, [hole], creases, 0.5, 1e-6)
    area = face_areas(made.vertices, made.faces).sum()
    assert area == pytest.approx(100 - np.pi, rel=2e-3)
    share, smallest = regular(made)
    assert share > 0.85 and smallest > 20
    edges = {tuple(sorted(e)) for f in made.faces.tolist() for e in zip(f, f[1:] + f[:1])}
    assert all(tuple(sorted(pair)) in edges for path in made.creases for pair in zip(path[:-1], path[1:]))
    on_first = {v for path in made.creases for v in path if abs(made.vertices[v, 1] - 4.1) < 1e-9}
    assert made.vertices[list(on_first), 0].min() == 0.0 and made.vertices[list(on_first), 0].max() == 10.0


def test_heights_of_the_curves_are_met_and_smooth_between(mesher):
    raised = SQUARE + [0, 0, 1] * SQUARE[:, :1]
    made = mesher(raised, [], [], 1.0, 1e-6)
    assert np.abs(made.vertices[:, 2] - made.vertices[:, 0]).max() < 0.3
    rim = boundary_vertices(made.vertices, made.faces)
    assert np.allclose(made.vertices[rim, 2], made.vertices[rim, 0], atol=1e-9)


def test_an_outline_on_the_mesh_layer_with_holes_and_creases(mesher, tmp_path):
    sketch = Sketch()
    sketch.curve(SQUARE, "CGC::Mesh")
    sketch.curve(rhino3dm.Circle(point3d((3, 7, 0)), 1.0).ToNurbsCurve(), "CGC::Mesh")
    sketch.curve([[5, -1, 0], [5.5, 11, 0]], "CGC::Creases")
    sketch.points(SQUARE[:4], "CGC::Supports")
    path = sketch.save(tmp_path / "a.3dm")
    with pytest.raises(FileError, match="the file has no mesh.*--edge-length"):
        read_3dm(path)
    model = read_3dm(path, edge_length=0.8)
    mesh = CGCMesh.from_problem(model.checked())
    assert len(mesh.regions()) == 2 and len(mesh.supports()) == 4 and len(mesh.boundary_loops()) == 2
    assert model.problem.faces[:, 0].size and not any("ignored: its layer" in note for note in model.notes)


def test_without_layers_the_widest_closed_curve_is_the_outline(mesher, tmp_path):
    sketch = Sketch()
    sketch.curve([[2, 2, 0], [6, 2, 0], [6, 6, 0], [2, 6, 0], [2, 2, 0]])
    sketch.curve(SQUARE)
    model = read_3dm(sketch.save(tmp_path / "a.3dm"), edge_length=1.0)
    mesh = CGCMesh.from_problem(model.checked())
    assert len(mesh.regions()) == 1 and len(mesh.boundary_loops()) == 2 and not model.diagnostics
    assert any("the closed curve inside it as a hole; draw closed creases on the layer CGC::Creases" in note for note in model.notes)


def test_what_cannot_be_meshed_is_said(mesher, tmp_path, monkeypatch):
    bow = np.array([[0, 0, 0], [5, 5, 0], [5, 0, 0], [0, 5, 0], [0, 0, 0]], float)
    with pytest.raises(MeshError, match="do not enclose an area"):
        mesher(bow, [], [], 0.5, 1e-6)
    with pytest.raises(MeshError, match="must be a positive number"):
        mesher(SQUARE, [], [], 0.0, 1e-6)
    sketch = Sketch()
    sketch.curve(SQUARE[:-1], "CGC::Mesh")
    with pytest.raises(FileError, match="is open with a gap of 10; close it"):
        read_3dm(sketch.save(tmp_path / "a.3dm"), edge_length=1.0)
    monkeypatch.setitem(sys.modules, "compas_cgal.triangulation", None)
    with pytest.raises(MeshError, match=r"pip install 'compas_cgc\[mesher\]'"):
        mesher(SQUARE, [], [], 1.0, 1e-6)


def test_an_outline_closed_within_the_tolerance_or_drawn_twice_is_one_outline(tmp_path, mesher):
    def ending(gap):
        return SQUARE + np.where(np.arange(5)[:, None] == 4, [gap, 0, 0], 0.0)

    sketch = Sketch()
    for points in (ending(5e-4), SQUARE[::-1]):
        sketch.curve(points, "CGC::Mesh")
    found = read_3dm(sketch.save(tmp_path / "a.3dm"), edge_length=2.0)
    assert face_areas(found.problem.vertices, found.problem.faces).sum() == pytest.approx(100)
    assert any("duplicate outlines" in note for note in found.notes)
    with pytest.raises(MeshError, match="is open with a gap of 0.05; close it"):
        outlined([("curve 0", ending(0.05))], [], np.empty((0, 3)), 2.0, 1e-3)


def test_curves_that_meet_end_to_end_are_one_outline(tmp_path, mesher):
    """A half disc drawn as an arc and its chord, in opposite directions, with a square hole of four lines."""
    angle = np.linspace(0.0, np.pi, 50)
    arc = 8.0 * np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    hole = 0.2 * SQUARE + [-1.0, 2.0, 0.0]
    sketch = Sketch()
    for points in (arc, arc[[0, -1]] + 4e-4, *(hole[[k, k + 1]] for k in range(4))):
        sketch.curve(points, "CGC::Mesh")
    found = read_3dm(sketch.save(tmp_path / "half.3dm"), edge_length=1.0).checked()
    # Chords of 1 m cut off about 0.3 % of the area.
    assert face_areas(found.vertices, found.faces).sum() == pytest.approx(0.5 * np.pi * 64.0 - 4.0, rel=5e-3)
    with pytest.raises(MeshError, match="is open with a gap of 16; close it .* or draw the missing part"):
        outlined([("curve 0", arc)], [], np.empty((0, 3)), 1.0, 1e-3)


def test_outlines_beside_each_other_are_parts_of_one_roof(mesher, tmp_path):
    sketch = Sketch()
    for points in (SQUARE, 0.3 * SQUARE + [2, 2, 0], 0.5 * SQUARE + [12, 0, 0]):
        sketch.curve(points, "CGC::Mesh")
    sketch.curve([[12, 0, 0], [17, 5, 0]], "CGC::Creases")
    found = read_3dm(sketch.save(tmp_path / "parts.3dm"), edge_length=1.0)
    mesh = CGCMesh.from_problem(found.checked())
    assert "from 2 outlines and 1 hole" in found.notes[0] and not any("ignored" in note for note in found.notes)
    assert len(mesh.boundary_loops()) == 3 and len(mesh.regions()) == 3
    assert face_areas(found.problem.vertices, found.problem.faces).sum() == pytest.approx(100 - 9 + 25)
    with pytest.raises(MeshError, match="do not enclose an area that can be meshed"):
        outlined([("a", SQUARE), ("b", 0.5 * SQUARE + [8, 2, 0])], [], np.empty((0, 3)), 1.0, 1e-3)


def test_a_hole_in_a_hole_is_named_by_its_place(mesher):
    holes = [0.2 * size * (SQUARE - 5) + 5 for size in (3, 1)]
    with pytest.raises(MeshError, match=r"the hole at \(4, 4\) lies in another hole"):
        mesher(SQUARE, holes, [], 1.0, 1e-6)


def test_curves_beside_the_outline_are_named_and_open_ones_are_told_to_be_closed(mesher, tmp_path):
    sketch = Sketch()
    sketch.curve(SQUARE)
    sketch.curve(0.5 * SQUARE + [20, 0, 0])
    model = read_3dm(sketch.save(tmp_path / "two.3dm"), edge_length=2.0)
    assert [note for note in model.notes if "lies outside the outline and was ignored" in note]
    assert not [note for note in model.notes if "inside it" in note]
    sketch = Sketch()
    sketch.curve(SQUARE[:4])
    with pytest.raises(FileError, match=r"or close an outline \(Rhino: Join, CloseCrv\) and give an edge length"):
        read_3dm(sketch.save(tmp_path / "open.3dm"), edge_length=2.0)


def test_supports_over_corners_lift_the_outline(mesher):
    columns = np.array([[0, 0, 3], [10, 10, 2], [10, 0, 0], [5, 5, 4]], float)
    made = outlined([("outline", SQUARE)], [], columns, 1.0, 1e-3)
    vertices = made.part.vertices
    assert any("moved to the height of the support above or below it at 2 places" in note for note in made.notes)
    for column in columns:
        assert np.linalg.norm(vertices - column, axis=1).min() < 1e-9
    # Sides between corners stay straight.
    side = vertices[np.abs(vertices[:, 1]) < 1e-9]
    assert np.allclose(side[:, 2], 3.0 - 0.3 * side[:, 0])
    # In a plan, curves without supports follow the surface between the supports.
    crease = Drawn("crease", "curve", np.array([[2, 0, 0], [2, 10, 0]], float), None, {})
    rims = [("outline", SQUARE), ("hole", 0.3 * SQUARE + [4, 4, 0])]
    made = outlined(rims, [crease], SQUARE[:4] + [0, 0, 3], 1.0, 1e-3)
    assert (made.part.vertices[:, 2] == 3.0).all() and len(made.creases) == 1
    made = outlined(rims, [crease], np.array([[0, 0, 3], [10, 0, 3], [10, 10, 0], [0, 10, 0]], float), 1.0, 1e-3)
    assert np.allclose(made.part.vertices[:, 2], 3.0 - 0.3 * made.part.vertices[:, 1])
    # Within a side a support kinks the outline.
    made = outlined([("outline", SQUARE)], [], np.array([[4, 0, 2], [0, 10, 1]], float), 1.0, 1e-3)
    side = made.part.vertices[np.abs(made.part.vertices[:, 1]) < 1e-9]
    assert np.allclose(side[:, 2], np.interp(side[:, 0], [0, 4, 10], [0, 2, 0])) and (side[:, 0] == 4.0).any()
    # A curve is no corner: an outline with one support stays level.
    angle = np.linspace(0, 2 * np.pi, 200)
    circle = np.column_stack([5 * np.cos(angle), 5 * np.sin(angle), 0 * angle])
    circle[-1] = circle[0]
    made = outlined([("outline", circle)], [], np.array([[5.0, 0, 3]]), 1.0, 1e-3)
    assert (made.part.vertices[:, 2] == 3.0).all()
    made = outlined([("outline", circle)], [], np.array([[5.0, 0, 3], [-5.0, 0, 1]]), 1.0, 1e-3)
    rim = made.part.vertices[np.linalg.norm(made.part.vertices[:, :2], axis=1) > 4.99]
    assert np.allclose(rim[:, 2], 3.0 - 2.0 * np.arctan2(np.abs(rim[:, 1]), rim[:, 0]) / np.pi, atol=2e-3)
