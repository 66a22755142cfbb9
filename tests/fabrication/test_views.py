"""Plans, sections and elevations to scale."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import shapely

from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import solve
from compas_cgc import write
from compas_cgc.cli import main
from compas_cgc.errors import CGCError
from compas_cgc.fabrication import draw_views
from compas_cgc.fabrication.plain_data import build_data
from compas_cgc.fabrication.views.level_lines import level_lines
from compas_cgc.fabrication.views.marks import letters
from compas_cgc.fabrication.views.projections import UPRIGHT_PADDING
from compas_cgc.fabrication.views.projections import Shape
from compas_cgc.fabrication.views.projections import elevation
from compas_cgc.fabrication.views.setting_out import chain
from compas_cgc.io.views import write_views

from ..support.constant_curvature import revolved_patch

WIDTH, DEPTH = 12.0, 8.0


def roof(units="Meters", scale=1.0):
    """A roof z = 3 - x²/12 over a rectangle around the origin, on two long sides."""
    mesh = CGCMesh.from_meshgrid(dx=WIDTH, dy=DEPTH, nx=24, ny=16)
    vertices, faces = mesh.to_vertices_and_faces(triangulated=True)
    V = np.array(vertices) - [WIDTH / 2, DEPTH / 2, 0.0]
    V[:, 2] = 3.0 - V[:, 0] ** 2 / 12.0
    problem = CGCProblem(scale * V, np.array(faces)).with_targets(0.0)
    own = problem.with_supports(np.flatnonzero(np.isclose(np.abs(V[:, 0]), WIDTH / 2)).tolist())
    return replace(own, drawing=own.drawing._replace(units=units, name="barrel"))


def of(drawn, layer):
    return [line for line in drawn.lines if line.layer == layer]


def test_level_lines_lie_on_the_level_and_closed_ones_end_where_they_begin():
    vertices, faces = revolved_patch(10, 0.02)
    middle = 0.5 * (vertices[:, 2].min() + vertices[:, 2].max())
    lines = level_lines(vertices, faces, vertices[:, 2], middle)
    assert lines and all(np.allclose(line[:, 2], middle) for line in lines)
    bowl = np.array([[np.cos(t), np.sin(t), 1.0] for t in np.linspace(0, 2 * np.pi, 12, endpoint=False)] + [[0, 0, 0.0]])
    fan = np.array([(12, k, (k + 1) % 12) for k in range(12)])
    (circle,) = level_lines(bowl, fan, bowl[:, 2], 0.5)
    assert len(circle) == 13 and np.array_equal(circle[0], circle[-1])


def test_sections_of_a_surface_in_two_parts_cross_it():
    """The middle of both lies between them."""
    whole = roof()
    count = len(whole.vertices)
    vertices = np.concatenate([whole.vertices, 0.5 * whole.vertices + [20.0, 0.0, 0.0]])
    parts = CGCProblem(vertices, np.concatenate([whole.faces, whole.faces + count])).with_targets(0.0)
    cuts = dict(draw_views(parts).cuts)
    assert sorted(cuts) == ["A", "B"] and np.ptp(cuts["B"][:, 1]) == pytest.approx(DEPTH)
    assert [name for name, _ in draw_views(whole).cuts] == ["A", "B"]


@pytest.mark.parametrize("units, scale", [("Meters", 1.0), ("Millimeters", 1000.0), ("Feet", 1 / 0.3048)])
def test_lengths_on_the_sheet_are_those_of_the_roof_at_the_scale(units, scale):
    drawn = draw_views(roof(units, scale), 100, sections=[np.array([0, 0, 0, 1]) * scale])
    outline = of(drawn, "OUTLINE")[0].points
    assert np.ptp(outline, axis=0) == pytest.approx([10 * WIDTH, 10 * DEPTH])
    (cut,) = of(drawn, "CUT")
    assert np.ptp(cut.points, axis=0) == pytest.approx([10 * DEPTH, 0.0], abs=1e-9)
    assert drawn.scale == 100 and {own.text for own in drawn.labels} >= {"Plan", "Section A-A", "South elevation", "1:100 (A3)"}


def test_a_section_is_the_surface_along_its_line():
    drawn = draw_views(roof(), 100, sections=[(0, 1, 1, 1)])
    (cut,) = of(drawn, "CUT")
    x = cut.points[:, 0] - 0.5 * (cut.points[0, 0] + cut.points[-1, 0])
    height = cut.points[:, 1] - cut.points[:, 1].min()
    # One centimetre on paper is a metre; the mesh is within a millimetre of the parabola at its vertices only.
    assert height == pytest.approx(30.0 - (x / 10) ** 2 / 12 * 10, abs=0.2)
    assert {letter for letter, _ in drawn.cuts} == {"A"}


def box(label):
    """Return the outline of a text as a polygon."""
    half = 0.5 * np.array([letters(label.text, label.height), label.height])
    corners = half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    turn = np.radians(label.angle)
    return shapely.Polygon(label.place + corners @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]))


def nine_regions():
    """Return nine regions of a square roof on columns of different heights, with the lowest arc of contours through most of them."""
    n = 18
    mesh = CGCMesh.from_meshgrid(dx=36.0, nx=n)
    mesh.set_creases(
        [[(n + 1) * i + k for i in range(n + 1)] for k in (6, 12)] + [[(n + 1) * k + i for i in range(n + 1)] for k in (6, 12)]
    )
    mesh.set_supports("corners")
    mesh.set_target(0.0012)
    problem = mesh.to_problem()
    V = problem.vertices.copy()
    V[:, 2] = 15.0 - 0.02 * ((V[:, 0] - 18.0) ** 2 + (V[:, 1] - 18.0) ** 2) - 0.01 * V[:, 0]
    return problem.with_vertices(V)


@pytest.mark.parametrize("surface, scale, interval", [(roof, 100, 0.1), (nine_regions, 500, 2.0), (nine_regions, 200, 1.0)])
def test_texts_of_the_plan_touch_neither_each_other_nor_lines(surface, scale, interval):
    drawn = draw_views(surface(), scale, contours=interval)
    contours = [own for own in drawn.labels if own.layer == "CONTOUR"]
    regions = [own for own in drawn.labels if own.layer == "REGION"]
    others = [own for own in drawn.labels if own.layer == "SUPPORT" or own.text == "N"]
    assert len(contours) > 5 and len(regions) > 1
    texts = [box(own) for own in (*contours, *regions, *others)]
    for k, text in enumerate(texts):
        assert not any(text.intersects(other) for other in texts[:k])
    plan = shapely.box(*shapely.union_all([box(own) for own in (*contours, *regions)]).buffer(20.0).bounds)
    for line in drawn.lines:
        path = shapely.LineString(np.vstack([line.points, line.points[:1]]) if line.closed else line.points)
        # Other views and the frame lie outside the plan.
        if line.layer in ("OUTLINE", "CREASE", "SECTION", "CONTOUR", "SUPPORT") and plan.contains(path):
            assert not any(text.intersects(path) for text in texts)


def test_creases_corners_and_columns_are_dimensioned_in_the_plan():
    arc = np.linspace(0.0, 1.0, 13)
    crease = np.column_stack([4.0 + 1.5 * np.sin(np.pi * arc), 8.0 * arc, 0.0 * arc])
    mesh = CGCMesh.from_outline([[0, 0], [12, 0], [12, 5], [9, 8], [0, 8]], creases=[crease.tolist()], edge_length=0.7)
    problem = mesh.to_problem().with_supports("corners").with_targets(0.01)
    drawn = draw_views(replace(problem, drawing=problem.drawing._replace(units="Meters")), 100)
    texts = [own for own in drawn.labels if own.layer == "DIMENSION"]
    across = [own.text for own in texts if own.angle == 0.0]
    # From the edge to the ends of the crease, to its crown, to the corner at the top and to the other edge, and the whole width.
    parts = [float(text) for text in across if text not in ("0.000", "12.000")]
    assert "12.000" in across and parts == pytest.approx([4.0, 1.5, 3.5, 3.0], abs=0.01) and sum(parts) == pytest.approx(12.0)
    down = [float(own.text) for own in texts if own.angle == 90.0]
    assert sorted(down) == pytest.approx([1.0, 3.0, 4.0, 8.0], abs=0.02)
    boxes = [box(own) for own in texts if own.height < 2.5]
    assert all(not one.intersects(other) for k, one in enumerate(boxes) for other in boxes[:k])
    # Parts without room for a text have none, and other texts stay apart.
    lines, labels = chain(
        np.array([0.0, 20.0, 22.0, 23.0, 60.0]), ["2.000", "0.200", "0.100", "3.700"], np.zeros(2), np.array([1.0, 0.0]), 12.0
    )
    assert [own.text for own in labels] == ["2.000", "0.200", "3.700"] and len(lines) == 20
    assert labels[1].place[1] < -12.0 < labels[0].place[1]


def test_nearly_straight_edges_between_corners_are_not_dimensioned():
    """The free edges of a roof on its corners move out by some millimetres."""
    flat = CGCMesh.from_meshgrid(dx=9.0, dy=7.0, nx=18, ny=14)
    vertices, faces = flat.to_vertices_and_faces(triangulated=True)
    V = np.array(vertices)
    V[:, :2] += 0.003 * (V[:, :2] - [4.5, 3.5]) * np.sin(np.pi * V[:, [1, 0]] / [7.0, 9.0]) / [4.5, 3.5]
    problem = CGCProblem(V, np.array(faces)).with_supports("corners").with_targets(0.0)
    assert Shape(problem).chains == []


def test_contour_lines_have_their_heights_and_supports_their_lines():
    drawn = draw_views(roof(), 100, contours=0.5)
    assert sorted({height for height, _ in drawn.contours}) == [0.5, 1.0, 1.5, 2.0, 2.5]
    for height, line in drawn.contours:
        assert np.allclose(line[:, 2], height)
    labels = {own.text for own in drawn.labels if own.layer == "CONTOUR"}
    assert labels >= {"0.5", "1.0", "2.5"}
    lengths = [np.linalg.norm(np.diff(line.points, axis=0), axis=1).sum() for line in of(drawn, "SUPPORT")]
    assert sum(own == pytest.approx(10 * DEPTH) for own in lengths) >= 2


def test_the_plan_names_regions_and_heights_of_supports():
    own = roof()
    stepped = own.with_supports(own.supports.tolist()).with_creases([np.flatnonzero(np.isclose(own.vertices[:, 0], 0.0)).tolist()])
    drawn = draw_views(stepped, 100)
    names = [label.text for label in drawn.labels if label.layer == "REGION"]
    assert names == ["region 0", "K = 0", "region 1", "K = 0"]
    (left, right) = ([label.place[0] for label in drawn.labels if label.text == f"region {k}"][0] for k in (0, 1))
    assert abs(left - right) > 10 * WIDTH / 4
    # All supports have one height, which the legend states once.
    assert "red: supports, all at 0.000" in " ".join(label.text for label in drawn.labels if label.layer == "TEXT")
    V = own.vertices.copy()
    V[np.argmax(V[:, :2].sum(axis=1)), 2] += 0.25
    lifted = draw_views(own.with_vertices(V), 100)
    assert {label.text for label in lifted.labels if label.layer == "SUPPORT"} == {"0.000", "0.250"}


def test_sections_show_no_supports_before_the_cut():
    corners = CGCMesh.from_meshgrid(dx=4.0, nx=4)
    vertices, faces = corners.to_vertices_and_faces(triangulated=True)
    V = np.array(vertices)
    held = [int(np.argmin(np.linalg.norm(V[:, :2] - at, axis=1))) for at in ([0, 0], [4, 0], [4, 4], [0, 4])]
    problem = CGCProblem(V, np.array(faces)).with_targets(0.0).with_supports(held)
    drawn = draw_views(problem, 100, sections=[(0, 2, 4, 2)])
    symbols = [line for line in of(drawn, "SUPPORT") if line.closed]
    # Four in the plan, two beyond the section, and four in every elevation of a level surface.
    assert len(symbols) == 4 + 2 + 4 * 4


def test_elevations_hide_what_is_behind():
    """From the south, a wall hides a lower one behind it, and a higher one only in part."""
    corners = np.array([[0.0, 0], [4, 0], [4, 1], [0, 1]])
    walls = [np.column_stack([corners[:, 0], np.full(4, y), h * corners[:, 1]]) for y, h in ((0.0, 2.0), (3.0, 1.0), (6.0, 3.0))]
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    problem = CGCProblem(np.vstack(walls), np.vstack([faces + 4 * k for k in range(3)]))
    view = elevation(Shape(problem), 10.0, "South", np.array([0.0, -1.0]))
    lengths = [np.linalg.norm(np.diff(line.points, axis=0), axis=1).sum() for line in view.lines if line.layer == "OUTLINE"]
    # The front wall is whole; of the last one, its top and parts of its sides above the front wall are seen.
    whole, above = 10 * 2 * (4 + 2), 10 * (4 + 2 * 1.5)
    assert sum(lengths) == pytest.approx(whole + above)


def test_views_lie_on_the_sheet_and_do_not_overlap():
    drawn = draw_views(roof(), sheet="A4")
    width, height = drawn.size
    points = np.vstack([line.points for line in drawn.lines])
    assert (points >= 10 - 1e-9).all() and (points <= np.array([width, height]) - 10 + 1e-9).all()
    assert drawn.scale in (200, 250)


@pytest.mark.parametrize(
    "given, sentence",
    [
        ({"scale": 1}, "at 1:1 the views do not fit on A0; use 1:"),
        ({"contours": 500.0}, "the height between contour lines, 500 meters, is far larger than the surface"),
        ({"scale": 50, "sheet": "A4"}, "at 1:50 the views do not fit on A4; use 1:200, or a larger sheet"),
        ({"sheet": "A7"}, "the sheet must be one of A4, A3, A2, A1, A0"),
        ({"sections": [(0, 0, 0, 0)]}, "the line of section A from its first to its second point must be two numbers"),
        ({"sections": [(0, 50, 1, 50)]}, "the line of section A does not cross the surface"),
        ({"contours": 1e-6}, "contour lines every 1e-06 would be"),
        ({"contours": -1}, "must be positive"),
        ({"north": (0, 0)}, "the direction of north"),
        ({"sections": [(0, 0, 1, 0)] * 27}, "at most 26 sections"),
    ],
)
def test_what_cannot_be_drawn_is_refused_with_the_remedy(given, sentence):
    with pytest.raises(CGCError, match=sentence.replace(".", r"\.")):
        draw_views(roof(), **given)


def test_the_dxf_has_the_size_of_the_roof_and_the_pdf_that_of_the_sheet(tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    drawn = draw_views(roof(), 100)
    write_views(tmp_path / "roof.dxf", drawn)
    document = ezdxf.readfile(tmp_path / "roof.dxf")
    assert not document.audit().errors and document.units == 6
    outline = next(own for own in document.modelspace().query("LWPOLYLINE[layer=='OUTLINE']"))
    assert np.ptp(np.array([point[:2] for point in outline.get_points()]), axis=0) == pytest.approx([WIDTH, DEPTH])
    assert document.modelspace().query("TEXT[layer=='CONTOUR']")
    assert document.layers.get("SUPPORT").rgb == (200, 30, 30)
    pytest.importorskip("matplotlib")
    write_views(tmp_path / "roof.pdf", drawn)
    content = (tmp_path / "roof.pdf").read_bytes()
    box = content[content.index(b"/MediaBox") :].split(b"]")[0].split(b"[")[1].split()
    assert [float(side) for side in box] == pytest.approx([0, 0, 420 / 25.4 * 72, 297 / 25.4 * 72], abs=0.01)
    write_views(tmp_path / "again.pdf", draw_views(roof(), 100))
    assert (tmp_path / "again.pdf").read_bytes() == content


def test_the_command_line_draws(tmp_path, capsys):
    pytest.importorskip("ezdxf")
    write(tmp_path / "roof.json", roof())
    words = ["--scale", "200", "--sheet", "A3", "--section", "0,0,1,0", "--section=-1,0,1,1", "--contours", "0.5", "--north", "1,1"]
    out = ["-o", str(tmp_path / "roof.dxf"), "-o", str(tmp_path / "roof.svg"), "--title", "Barrel $1"]
    assert main(["drawings", str(tmp_path / "roof.json"), *words, *out]) == 0
    said = capsys.readouterr().out
    assert "7 views at 1:200 on A3: plan, section A-A, section B-B, south elevation" in said
    assert (tmp_path / "roof.dxf").stat().st_size and (tmp_path / "roof.svg").stat().st_size


def test_plain_data_is_json():
    own = roof()
    drawn = draw_views(own)
    told = json.loads(json.dumps(build_data("drawings", own, drawn)))
    assert {line["layer"] for line in told["lines"]} <= set(told["layers"]) and told["text"] == str(drawn)
    assert len(told["contours"]) == len(drawn.contours) and told["size"] == [420.0, 297.0]


def test_silhouettes_of_a_steep_roof_are_single_lines():
    """Edges between faces towards and away from the viewer are a zigzag over the width of a face."""
    mesh = CGCMesh.from_outline([(0, 0, 0), (12, 0, 0), (12, 9, 0), (0, 9, 0)], 0.45)
    mesh.set_supports("boundary")
    mesh.set_target(0.025)
    drawn = elevation(Shape(solve(mesh).problem), 10.0, "South", np.array([0.0, -1.0]))
    lines = [line.points - UPRIGHT_PADDING[0] for line in drawn.lines if line.layer == "OUTLINE"]
    sides = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in lines])
    for level in (5.0, 10.0, 15.0, 30.0):
        (x0, y0), (x1, y1) = sides[(sides[:, 0, 1] < level) != (sides[:, 1, 1] < level)].transpose(1, 2, 0)
        x = x0 + (level - y0) / (y1 - y0) * (x1 - x0)
        assert (x < 60.0).any() and (x > 60.0).any()
        assert np.ptp(x[x < 60.0]) < 1.0 and np.ptp(x[x > 60.0]) < 1.0


def test_a_long_low_hall_is_drawn_in_columns_at_a_larger_scale():
    hall = roof(scale=[20.0 / 3.0, 5.0, 2.5])
    drawn = draw_views(hall)
    assert (drawn.sheet, drawn.scale) == ("A3", 500)
