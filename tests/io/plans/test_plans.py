"""Drawings in DXF and .3dm files: what is read, what is left out, and what meshes."""

from __future__ import annotations

import ezdxf
import numpy as np
import pytest

from compas_cgc.discrete import face_areas
from compas_cgc.errors import FileError
from compas_cgc.io import read_problem
from compas_cgc.io.plans import read_plan
from compas_cgc.io.plans.plan import roles
from compas_cgc.io.plans.problem import problem_of_plan
from compas_cgc.io.plans.problem import read_dxf
from tests.support.rhino_models import Sketch

SQUARE = [(0, 0), (10, 0), (10, 6), (0, 6)]


@pytest.fixture
def drawn(tmp_path):
    """Write a drawing and read its plan."""

    def make(draw, name="plan.dxf", **how):
        document = ezdxf.new("R2010", units=how.pop("units", 4))
        draw(document, document.modelspace())
        path = tmp_path / name
        document.saveas(path, fmt=how.pop("fmt", "asc"))
        return read_plan(path, **how)

    return make


def _square(document, model):
    model.add_lwpolyline(SQUARE, close=True)


def _box(plan):
    points = np.concatenate([curve.points for curve in plan.curves])
    return np.concatenate([points.min(axis=0)[:2], points.max(axis=0)[:2]])


@pytest.mark.parametrize("fmt", ["asc", "bin"])
def test_text_and_binary_files_give_the_same_plan(drawn, fmt):
    plan = drawn(_square, fmt=fmt)
    assert plan.unit == "Millimeters" and roles(plan) == ["outline"]
    assert np.array_equal(_box(plan), [0, 0, 10, 6])


def test_curves_lie_where_their_normal_and_their_blocks_put_them(drawn):
    def draw(document, model):
        flipped = {"extrusion": (0, 0, -1)}
        model.add_lwpolyline([(-x, y) for x, y in SQUARE], close=True, dxfattribs=flipped)
        model.add_circle((-3, 2), 1, dxfattribs=flipped)
        block = document.blocks.new("hole")
        block.add_circle((0, 0), 0.5)
        outer = document.blocks.new("outer")
        outer.add_blockref("hole", (1, 0), dxfattribs={"xscale": -2, "yscale": 2})
        model.add_blockref("outer", (6, 3))

    plan = drawn(draw)
    assert roles(plan) == ["outline", "hole", "hole"]
    assert plan.curves[1].circle == pytest.approx((3, 2, 1))
    nested = plan.curves[2].points
    assert nested[:, :2].min(axis=0) == pytest.approx([6, 2], abs=1e-3) and nested[:, :2].max(axis=0) == pytest.approx([8, 4], abs=1e-3)


def test_splines_arcs_and_bulges_keep_their_length(drawn):
    def draw(document, model):
        model.add_lwpolyline([(0, 0, 0, 0, 1), (10, 0, 0, 0, 1)], format="xyseb", close=True)
        model.add_arc((5, 0), 2, 0, 90)
        model.add_spline([(3, -1), (5, -2), (7, -1)])

    circle, arc, spline = drawn(draw).curves
    length = [np.linalg.norm(np.diff(curve.points, axis=0), axis=1).sum() for curve in (circle, arc, spline)]
    assert length[:2] == pytest.approx([10 * np.pi, np.pi], rel=2e-3)
    assert circle.is_closed and not arc.is_closed and np.allclose(spline.points[[0, -1], :2], [[3, -1], [7, -1]])


def test_small_gaps_are_closed_and_reported_and_wide_ones_on_request(drawn):
    def draw(gap):
        def lines(document, model):
            for a, b in zip(SQUARE, [*SQUARE[1:], SQUARE[0]]):
                model.add_line((a[0] + gap, a[1]), b)

        return lines

    small = drawn(draw(1e-3))
    assert roles(small) == ["outline"] and any("4 gaps" in note and "0.001" in note for note in small.notes)
    assert roles(drawn(draw(1e-3), join=0.0)) == ["crease"] * 4
    wide = drawn(draw(0.2))
    assert "outline" not in roles(wide)
    assert roles(drawn(draw(0.2), join=0.25)) == ["outline"]


def test_three_ends_at_one_place_stay_apart_and_duplicates_go(drawn):
    def draw(document, model):
        for end in [(5, 0), (0, 5), (-5, 0)]:
            model.add_line((0, 0), end)
        model.add_line((5, 0), (0, 0))

    plan = drawn(draw)
    assert len(plan.curves) == 3 and "1 duplicate curve was removed, 5 long together" in plan.notes


def test_hidden_layers_paper_space_and_other_objects_are_named(drawn):
    def draw(document, model):
        _square(document, model)
        document.layers.add("grid").off()
        model.add_line((0, 3), (10, 3), dxfattribs={"layer": "grid"})
        model.add_text("roof")
        model.add_text("plan")

    plan = drawn(draw)
    assert roles(plan) == ["outline"]
    assert {"left out: 2 texts", "left out, on layers that are hidden: grid (1)"} <= set(plan.notes)
    assert roles(drawn(draw, layers=["GRID", "0"])) == ["outline", "crease"]
    with pytest.raises(FileError, match="no layer 'walls'; the layers are 0, "):
        drawn(draw, layers=["walls"])
    paper = drawn(lambda document, model: document.layout("Layout1").add_line((0, 0), (1, 1)))
    assert any("1 objects lie in paper space" in note or "2 objects lie in paper space" in note for note in paper.notes)


def test_layers_that_only_objects_name_can_be_chosen(tmp_path):
    text = "0\nSECTION\n2\nENTITIES\n"
    for layer, y in (("ROOF", 1), ("GRID", 5)):
        text += f"0\nLINE\n8\n{layer}\n10\n0\n20\n{y}\n11\n9\n21\n{y}\n"
    (path := tmp_path / "lines.dxf").write_text(text + "0\nENDSEC\n0\nEOF\n")
    assert [curve.layer for curve in read_plan(path, layers=["roof"]).curves] == ["ROOF"]
    with pytest.raises(FileError, match="no layer 'wall'.*ROOF"):
        read_plan(path, layers=["wall"])


def test_the_plural_of_what_was_left_out(drawn):
    def draw(document, model):
        for _ in range(2):
            model.add_line((1, 1), (1, 1))
            model.add_hatch()

    assert "left out: 2 hatches, 2 lines without length" in drawn(draw).notes


def test_blocks_that_multiply_are_refused(tmp_path):
    document = ezdxf.new()
    below = document.blocks.new("b0")
    for _ in range(10):
        below.add_line((0, 0), (1, 1))
    for level in range(1, 9):
        block = document.blocks.new(f"b{level}")
        for k in range(10):
            block.add_blockref(f"b{level - 1}", (k, level))
    document.modelspace().add_blockref("b8", (0, 0))
    document.saveas(tmp_path / "bomb.dxf")
    with pytest.raises(FileError, match=r"1.11e\+09 objects including those in blocks, more than 200,000"):
        read_plan(tmp_path / "bomb.dxf")


@pytest.mark.parametrize("content", [b"", b"\0" * 40, b"AutoCAD Binary DXF\r\n\x1a\0garbage", b"0\nSECTION\n2\nENTITIES\n0\nLINE\n"])
def test_damaged_files_are_refused_or_empty(tmp_path, content):
    path = tmp_path / "broken.dxf"
    path.write_bytes(content)
    try:
        plan = read_plan(path)
    except FileError as error:
        assert "broken.dxf" in str(error) and "export it again" in str(error)
    else:
        assert not plan.curves


def test_a_plan_becomes_a_mesh_with_holes_creases_and_supports(tmp_path):
    document = ezdxf.new(units=6)
    model = document.modelspace()
    _square(document, model)
    model.add_circle((7, 3), 1)
    model.add_line((4, 0), (4, 6))
    model.add_point((2, 3))
    document.saveas(tmp_path / "roof.dxf")
    read = read_dxf(tmp_path / "roof.dxf", edge_length=0.5)
    problem = read.checked()
    assert problem.drawing.units == "Meters" and len(problem.creases) and len(problem.supports) == 1
    assert np.allclose(problem.vertices[problem.supports[0]], [2, 3, 0])
    area = np.linalg.norm(
        np.cross(*(problem.vertices[problem.faces[:, k]] - problem.vertices[problem.faces[:, 0]] for k in (1, 2))), axis=1
    )
    assert 0.5 * area.sum() == pytest.approx(60 - np.pi, rel=5e-3)
    with pytest.raises(FileError, match="give an edge length"):
        read_dxf(tmp_path / "roof.dxf")


def test_faces_of_a_drawing_are_its_mesh(tmp_path):
    document = ezdxf.new()
    model = document.modelspace()
    for k in range(3):
        model.add_3dface([(k, 0, 0), (k + 1, 0, 0), (k + 1, 1, 1), (k, 1, 1)])
    document.saveas(tmp_path / "faces.dxf")
    problem = read_dxf(tmp_path / "faces.dxf").checked()
    assert len(problem.vertices) == 8 and len(problem.faces) == 6


def test_an_open_outline_is_refused_with_its_gap(tmp_path):
    document = ezdxf.new(units=6)
    document.modelspace().add_lwpolyline([(0, 0), (9, 0), (9, 5), (0, 5), (0, 0.4)])
    document.saveas(tmp_path / "open.dxf")
    with pytest.raises(FileError, match=r"gap of 0.4 m between start and end at \(0, 0.4\)"):
        read_dxf(tmp_path / "open.dxf", edge_length=1.0)


def test_a_3dm_file_gives_the_same_plan(tmp_path):
    sketch = Sketch()
    sketch.curve([[*corner, 0] for corner in [*SQUARE, SQUARE[0]]])
    sketch.curve([[4, 0, 0], [4, 6, 0]])
    sketch.points([[2, 3, 0]])
    plan = read_plan(sketch.save(tmp_path / "plan.3dm"))
    assert roles(plan) == ["outline", "crease"] and np.allclose(plan.points, [[2, 3, 0]])


def test_north_is_that_of_the_geographic_location(tmp_path, drawn):
    def located(document, model):
        _square(document, model)
        model.new_geodata({"north_direction": (3.0, 4.0)})
        document.header["$NORTHDIRECTION"] = 0.6435

    def angle_only(document, model):
        _square(document, model)
        document.header["$NORTHDIRECTION"] = 0.5236

    plan = drawn(located)
    assert plan.north == pytest.approx((0.6, 0.8)) and not any("north" in note for note in plan.notes)
    assert read_problem(tmp_path / "plan.dxf", edge_length=1.0).checked().drawing.north == pytest.approx((0.6, 0.8))
    unread = drawn(angle_only)
    assert unread.north == (0.0, 1.0)
    (note,) = [note for note in unread.notes if "north" in note]
    assert note.startswith("the drawing has an angle of 30° between y and north") and "y is used as north" in note


def test_an_inner_closed_curve_is_a_hole_from_every_door(tmp_path):
    inner = [[4, 2, 0], [6, 2, 0], [6, 4, 0], [4, 4, 0]]
    sketch = Sketch()
    for ring in ([[*corner, 0] for corner in SQUARE], inner):
        sketch.curve([*ring, ring[0]])
    model = sketch.save(tmp_path / "roof.3dm")
    document = ezdxf.new(units=6)
    document.layers.add("inside")
    _square(document, document.modelspace())
    document.modelspace().add_lwpolyline([p[:2] for p in inner], close=True, dxfattribs={"layer": "inside"})
    document.saveas(drawing := tmp_path / "roof.dxf")
    problems = [read_problem(path, edge_length=1.0).checked() for path in (model, drawing)]
    problems.append(problem_of_plan(read_plan(model), "roof", 1.0).checked())
    surface = sum(face_areas(problems[0].vertices, problems[0].faces))
    assert surface == pytest.approx(60 - 4)
    assert all(sum(face_areas(own.vertices, own.faces)) == pytest.approx(surface) and not len(own.creases) for own in problems)
    folded = read_problem(drawing, edge_length=1.0, layers={"mesh": "0", "creases": "INSIDE"})
    assert sum(face_areas(folded.problem.vertices, folded.problem.faces)) == pytest.approx(60) and len(folded.problem.crease_paths()) == 1


@pytest.mark.parametrize("x", [float("nan"), 1e100])
def test_coordinates_out_of_range_are_left_out_and_named(tmp_path, x):
    document = ezdxf.new()
    space = document.modelspace()
    space.add_lwpolyline([(0, 0), (10, 0), (10, 8), (0, 8)], close=True)
    space.add_ellipse((5, 5), (x, 0), 0.5)
    space.add_line((1, 1), (x, 2))
    space.add_point((x, 1))
    document.saveas(tmp_path / "plan.dxf")
    reason = "with a coordinate that is not finite or exceeds 1e+12"
    read = read_problem(tmp_path / "plan.dxf", edge_length=2.0)
    assert f"left out: 2 curves {reason}, 1 point {reason}" in read.notes
    assert np.ptp(read.problem.vertices, axis=0) == pytest.approx([10, 8, 0])
