"""Unrolling: lengths, areas and seams against closed forms, every format read back, and what is refused."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
import zipfile

import numpy as np
import pytest
from scipy.spatial import Delaunay

from compas_cgc import CGCError
from compas_cgc import CGCProblem
from compas_cgc import get
from compas_cgc import read
from compas_cgc import solve
from compas_cgc.discrete import face_areas
from compas_cgc.fabrication import draw_sheets
from compas_cgc.fabrication import flatten
from compas_cgc.fabrication import panels
from compas_cgc.fabrication import unfold
from compas_cgc.fabrication import unroll
from compas_cgc.fabrication import widest_panel
from compas_cgc.fabrication.allowance import reach
from compas_cgc.fabrication.allowance import widened
from compas_cgc.fabrication.assembly import draw_plan
from compas_cgc.fabrication.drawing import LETTER_WIDTH
from compas_cgc.fabrication.drawing import overlap
from compas_cgc.fabrication.drawing import text_box
from compas_cgc.fabrication.figures import in_mm
from compas_cgc.fabrication.figures import in_square_metres
from compas_cgc.fabrication.flattening import flattening_constant
from compas_cgc.fabrication.flattening import strain_of_width
from compas_cgc.fabrication.nesting import nest
from compas_cgc.fabrication.outlines import signed_area
from compas_cgc.fabrication.piece_checks import sharpest_corner
from compas_cgc.fabrication.piece_list import cut_list
from compas_cgc.fabrication.piece_list import cut_list_text
from compas_cgc.fabrication.pieces import best_box
from compas_cgc.fabrication.seams import opens_to_disks
from compas_cgc.fabrication.seams import seam_edges
from compas_cgc.fabrication.tables import edge_table
from compas_cgc.io.patterns import write_patterns

from ..support.constant_curvature import cone
from ..support.constant_curvature import rectangle
from ..support.constant_curvature import revolved_patch
from ..support.shapes import grid
from ..support.shapes import icosphere
from ..support.shapes import torus
from ..support.tables import rows_and_notes

SHEET = (3.0, 1.5)
TEXTS = ("NODE", "LABEL", "RULING", "SEAM")  # layers with texts on pieces


def ring(rows=8, around=30) -> CGCProblem:
    return CGCProblem(*cone(rows, around)).with_supports("boundary").with_targets(0.0)


def vault(n=12) -> CGCProblem:
    """Two barrels of one radius over a square, which meet along its diagonals: four regions of K = 0."""
    vertices, faces = grid(n, 8.0)
    x, y = (vertices[:, :2] - 4.0).T
    vertices[:, 2] = np.sqrt(25.0 - np.minimum(np.abs(x), np.abs(y)) ** 2)
    # Every square is split along the diagonal of the vault that is nearer to it.
    a, b, c, d = (faces[::2, 0], faces[::2, 1], faces[::2, 2], faces[1::2, 2])
    falling = (x[a] + x[c]) * (y[a] + y[c]) < -1e-9
    first = np.where(falling[:, None], np.column_stack([a, b, d]), np.column_stack([a, b, c]))
    second = np.where(falling[:, None], np.column_stack([b, c, d]), np.column_stack([a, c, d]))
    faces = np.stack([first, second], axis=1).reshape(-1, 3)
    m = n + 1
    creases = [[i * m + i for i in range(m)], [i * m + n - i for i in range(m)]]
    return CGCProblem(vertices, faces).with_supports("boundary").with_creases(creases).with_targets(0.0)


@pytest.fixture(scope="module")
def rolled():
    return unroll(ring(10, 60), SHEET)


@pytest.fixture(scope="module")
def folded():
    """The irregular ring, whose surface is folded at edges of its mesh."""
    return unroll(irregular_ring(), rulings=0, rough=True)


@pytest.fixture(scope="module")
def cut():
    """The vault on sheets of 3.0 x 1.5."""
    return unroll(vault(), SHEET, rough=True)


@pytest.mark.parametrize(("rows", "around"), [(5, 24), (100, 200)])
def test_a_ring_of_any_size_keeps_its_edges_and_closes(rows, around):
    vertices, faces = cone(rows, around)
    seams = seam_edges(vertices, faces, np.zeros(len(vertices), bool))
    laid = unfold(vertices, faces, seams)
    assert len(seams) == rows - 1
    assert laid.edge_error < 1e-11 and laid.gap < 1e-11
    # A frustum lies in a sector: its outermost points at the distance of the bottom from the apex.
    slant = np.hypot(3.0, 6.0)
    apart = np.linalg.norm(laid.plane[:, None] - laid.plane[None, :1], axis=2).max()
    assert apart <= 2 * slant


def test_frames_are_carried_without_growing_errors():
    """The angle of the sector, after a way all around: 2 pi r / l of the polygon that the frustum's edge is."""
    vertices, faces = cone(4, 90)
    seams = seam_edges(vertices, faces, np.zeros(len(vertices), bool))
    laid = unfold(vertices, faces, seams)
    bottom = laid.plane[np.isin(laid.origin, np.arange(90))]
    slant = np.hypot(3.0, 6.0)
    chord = 2 * 3.0 * np.sin(np.pi / 90)
    sector = 90 * 2 * np.arcsin(chord / 2 / slant)
    farthest = 2 * slant * np.sin(min(sector, np.pi) / 2)
    assert np.linalg.norm(bottom[:, None] - bottom[None], axis=2).max() == pytest.approx(farthest, rel=1e-4)


@pytest.mark.parametrize(
    ("shape", "cones", "count"),
    [(torus(8, 10), False, 2), (icosphere(0), True, 1), (grid(4), False, 0)],
    ids=["two ways around a torus", "through every corner of an icosahedron", "none for a disk"],
)
def test_seams_open_every_surface_to_a_disk(shape, cones, count):
    vertices, faces = shape
    seams = seam_edges(vertices, faces, np.full(len(vertices), cones))
    laid = unfold(vertices, faces, seams)
    assert opens_to_disks(laid.faces)
    assert (len(seams) > 0) == (count > 0)
    if cones:
        assert set(seams.ravel().tolist()) == set(range(len(vertices)))
        assert laid.gap < 1e-13


def test_pieces_keep_area_lie_within_their_sheet_and_fit_each_other(cut):
    area = face_areas(cut.problem.vertices, cut.problem.faces).sum()
    assert cut.area == pytest.approx(area, rel=1e-12) and cut.area_in_space == pytest.approx(area, rel=1e-12)
    assert cut.seam_mismatch < 1e-12
    assert len(cut.pieces) > 4 and cut.largest_strain < 1e-12
    for piece in cut.pieces:
        points = np.concatenate([loop.points for loop in piece.loops])
        assert points.min() >= 0 and (points.max(axis=0) <= SHEET).all()
    for seam in cut.seams:
        here, there = (np.linalg.norm(np.diff(side, axis=0), axis=1) for side in seam.sides)
        assert np.abs(here - there).max() < 1e-12
    # Every outline belongs to one seam, twice, or ends the surface.
    outline = sum(len(loop.nodes) for piece in cut.pieces for loop in piece.loops)
    along = sum(len(seam.nodes) - 1 for seam in cut.seams)
    assert outline > 2 * along > 0


def test_margins_of_a_sheet_stay_free():
    cut = unroll(vault(), (1.5, 3.0), rough=True, regions=[0], margin=0.05, spacing=0.02)
    points = np.concatenate([loop.points for piece in cut.pieces for loop in piece.loops])
    assert points.min() >= 0.05 - 1e-12 and (points.max(axis=0) <= np.array(SHEET) - 0.05 + 1e-12).all()
    assert points.min() == pytest.approx(0.05)
    assert cut.sheet == SHEET and cut.area == pytest.approx(cut.area_in_space, rel=1e-12)
    with pytest.raises(CGCError, match="margins of 0.8 leave no room on a sheet of 3 x 1.5"):
        unroll(vault(), SHEET, rough=True, margin=0.8)
    with pytest.raises(CGCError, match="margin at the edges of a sheet must be at least 0"):
        unroll(vault(), SHEET, rough=True, margin=-0.1)


def test_pieces_are_a_hundredth_of_a_sheets_width_apart_unless_told():
    shapely = pytest.importorskip("shapely")
    for given, apart in ((None, 0.03), (0.1, 0.1), (0.0, 0.0)):
        cut = unroll(vault(), (6.0, 3.0), rough=True, regions=[0, 1], spacing=given, rulings=0)
        assert cut.stock.spacing == pytest.approx(apart) and cut.sheets < len(cut.pieces)
        shapes = [(piece.sheet, shapely.Polygon(piece.loops[0].points)) for piece in cut.pieces]
        gaps = [a.distance(b) for i, (sheet, a) in enumerate(shapes) for other, b in shapes[:i] if sheet == other]
        assert min(gaps) >= apart - 1e-12
    # Without sheets they are as far apart as the largest piece asks.
    assert unroll(vault(), rough=True, regions=[0], rulings=0).stock.spacing


def test_allowances_stand_off_every_edge_and_have_room_on_sheets(cut):
    shapely = pytest.importorskip("shapely")
    own = unroll(vault(), SHEET, rough=True, margin=0.05, allowance=0.03, spacing=0.01)
    assert own.area == pytest.approx(cut.area, rel=1e-12) and own.seam_mismatch < 1e-12
    strips = []
    for piece in own.pieces:
        inner, outer = shapely.Polygon(piece.loops[0].points), shapely.Polygon(piece.allowance[0])
        assert len(piece.allowance) == 1 and signed_area(piece.allowance[0]) > piece.area and outer.contains(inner)
        away = shapely.distance(inner, shapely.points(piece.allowance[0]))
        assert away.min() >= 0.03 - 1e-12 and away.max() <= 4 * 0.03 / np.cos(np.arcsin(0.25)) + 1e-12
        # Every edge but those short ones at inward corners has its parallel.
        assert inner.exterior.distance(outer.exterior) == pytest.approx(0.03, rel=1e-9)
        assert piece.allowance[0].min() >= 0.05 - 1e-12 and (piece.allowance[0].max(axis=0) <= np.array(SHEET) - 0.05 + 1e-12).all()
        # Rhino takes no curve with a point twice.
        assert np.linalg.norm(piece.allowance[0] - np.roll(piece.allowance[0], 1, axis=0), axis=1).min() > 1e-10
        strips.append((piece.sheet, outer))
    gaps = [a.distance(b) for i, (sheet, a) in enumerate(strips) for other, b in strips[:i] if sheet == other]
    assert not gaps or min(gaps) >= 0.01 - 1e-12
    lines = [line.points for line in draw_sheets(own).lines if line.layer == "CUT"]
    assert len(lines) == len(own.pieces) and not any(line.layer == "OUTLINE" for line in draw_sheets(cut).lines)
    with pytest.raises(CGCError, match="an allowance of 0.2 leaves no room for pieces on a sheet of 3 x 1.5; use less than 0.188"):
        unroll(vault(), SHEET, rough=True, allowance=0.2)


def test_cut_lines_run_in_the_middle_of_the_kerf():
    """Half the kerf outside the piece everywhere, and inside holes: what the tool leaves is the piece."""
    shapely = pytest.importorskip("shapely")
    own = unroll(vault(), (12.0, 12.0), rough=True, kerf=0.004, spacing=0.01)
    titles = [text.text for text in draw_sheets(own).texts if text.layer == "SHEET"]
    assert titles and all("CUT: middle of a kerf of 4 mm" in title for title in titles)
    for piece in own.pieces:
        cut, outline = shapely.Polygon(piece.allowance[0]), shapely.Polygon(piece.loops[0].points)
        assert cut.buffer(-0.002, join_style="mitre").symmetric_difference(outline).area < 1e-6 * outline.area


def test_allowances_are_mitred():
    pytest.importorskip("shapely")
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    (around,) = widened([square], 0.1)
    assert signed_area(around) == pytest.approx(1.44, rel=1e-14)
    corner = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]])
    assert signed_area(widened([corner], 0.1)[0]) == pytest.approx(2.2 * 2.2 - 1.0, rel=1e-14)
    # A hole gets smaller, and one narrower than two strips is none any more.
    outer, hole = widened([4.0 * square - 1.0, square[::-1]], 0.1)
    assert signed_area(outer) == pytest.approx(4.2**2) and signed_area(hole) == pytest.approx(-(0.8**2))
    assert len(widened([4.0 * square - 1.0, 0.1 * square[::-1]], 0.1)) == 1
    # A long mitre is cut off square, four widths from its corner.
    needle = np.array([[0.0, 0.0], [3.0, -0.2], [3.0, 0.2]])
    (strip,) = widened([needle], 0.1)
    assert strip[:, 0].min() == pytest.approx(-0.4, rel=1e-12) and np.sum(np.isclose(strip[:, 0], -0.4)) == 2
    # An edge shorter than a strip at an inward corner: its own crosses the next one's, and the point where they do is one.
    step = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.05, 1.0], [1.05, 1.0 + 1e-12], [1.0, 1.0 + 1e-12], [1.0, 2.0], [0.0, 2.0]])
    (around,) = widened([step], 0.1)
    assert np.linalg.norm(around - np.roll(around, 1, axis=0), axis=1).min() > 1e-10 and signed_area(around) == pytest.approx(3.84)
    assert np.allclose(reach([needle], 0.1).min(axis=0), strip.min(axis=0)) and widened([square], 0.0) == []


def test_the_cut_list_says_what_a_workshop_asks(cut, tmp_path):
    (path,) = write_patterns(tmp_path / "cut.list.csv", cut)
    rows, _ = rows_and_notes(path.open())
    assert {row["piece"]: int(row["sheet"]) - 1 for row in rows} == {piece.label: piece.sheet for piece in cut.pieces}
    assert sum(float(row["area in m2"]) for row in rows) == pytest.approx(cut.area, abs=1e-3 * len(rows))
    for row, piece in ((row, piece) for row in rows for piece in cut.pieces if piece.label == row["piece"]):
        points = piece.loops[0].points
        around = np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1).sum()
        assert float(row["perimeter in mm"]) == pytest.approx(1000 * around, abs=0.06) and row["mould"] == ""
        assert [float(row[name]) for name in ("length in mm", "width in mm")] == pytest.approx(
            sorted(1000 * np.ptp(points, axis=0), reverse=True), abs=0.06
        )
    beside = {row["piece"]: set(row["neighbours"].split()) for row in rows}
    assert all(one in beside[other] for one, others in beside.items() for other in others)
    seams = {frozenset(cut.pieces[k].label for k in seam.pieces) for seam in cut.seams}
    assert seams == {frozenset((one, other)) for one, others in beside.items() for other in others}
    # The vault stands on its edge; what does not touch it comes later.
    course = {row["piece"]: int(row["course"]) for row in rows}
    held = cut.problem.vertices[cut.problem.supports]
    for number, piece in enumerate(cut.pieces):
        nodes = cut.patchwork.space[cut.patchwork.faces[cut.patchwork.piece == number]].reshape(-1, 3)
        stands = (np.linalg.norm(nodes[:, None] - held, axis=2) < 1e-12).any()
        assert (course[piece.label] == 1) == stands
        assert stands or min(course[label] for label in beside[piece.label]) == course[piece.label] - 1


def test_the_plan_has_every_piece_in_its_place(cut):
    drawing = draw_plan(cut)
    outlines = [line.points for line in drawing.lines if line.layer == "OUTLINE"]
    # A vault covers its plan once.
    assert sum(map(signed_area, outlines)) == pytest.approx(64.0, rel=1e-12) and drawing.size[0] == pytest.approx(8.0)
    assert {text.text.split()[0] for text in drawing.texts if text.layer == "LABEL"} == {piece.label for piece in cut.pieces}
    assert {text.text for text in drawing.texts if text.layer == "SEAM"} == {str(seam.number) for seam in cut.seams}
    boxes = [
        (text.place, 0.35 * text.height * np.array([len(text.text), 1.0])) for text in drawing.texts if text.layer in ("LABEL", "SEAM")
    ]
    apart = [(np.abs(a - b) > x + y).any() for k, (a, x) in enumerate(boxes) for b, y in boxes[:k]]
    assert all(apart)
    # A triangle points to every support, and the legend states where heights are.
    problem = cut.problem
    tips = {tuple(np.round(line.points[0], 9)) for line in drawing.lines if line.layer == "MARK"}
    assert tips == {tuple(place) for place in np.round((problem.vertices - problem.vertices.min(axis=0))[problem.supports, :2], 9).tolist()}
    legend = " ".join(text.text for text in drawing.texts if text.layer == "LEGEND")
    assert (
        "MARK: triangle with its tip at a supported point" in legend and "heights: see the pieces in place, in the separate file" in legend
    )
    shapely = pytest.importorskip("shapely")
    places = {piece.label: shapely.Polygon(points) for piece, points in zip(cut.pieces, outlines)}
    leaders = [line.points for line in drawing.lines if line.layer == "LABEL"]
    for text in (text for text in drawing.texts if text.layer == "LABEL"):
        x, y = 0.5 * text.height * np.array([0.7 * len(text.text), 1.0])
        place = places[text.text.split()[0]]
        # Names that have no room lie beside their piece, at the end of a line from it.
        own = [line for line in leaders if (np.abs(line[1] - text.place) < 0.5 * text.height * np.array([len(text.text), 1.1])).all()]
        assert place.contains(shapely.Point(own[0][0]) if own else shapely.box(*(text.place - [x, y]), *(text.place + [x, y])))
    assert 0 < len(leaders) < 0.3 * len(cut.pieces) and min(text.height for text in drawing.texts if text.layer == "LABEL") > 0.04
    with pytest.raises(CGCError, match="a plan is drawn from patterns"):
        draw_plan(cut.problem)


def test_courses_in_a_plan_without_supports_start_at_the_lowest_piece():
    drawing = draw_plan(unroll(vault(8).with_supports([]), SHEET, rough=True, rulings=0))
    assert any("with courses from the lowest piece" in text.text for text in drawing.texts if text.layer == "SHEET")
    assert not any(line.layer == "MARK" for line in drawing.lines)


@pytest.mark.nightly
def test_there_may_be_a_file_for_each_sheet(cut, tmp_path):
    paths = write_patterns(tmp_path / "cut.dxf", cut, per_sheet=True)
    assert len(paths) == cut.sheets == len(list(tmp_path.iterdir())) and paths[0].name == "cut-01.dxf"
    for sheet, path in enumerate(paths):
        outlines, texts = read_dxf(path)
        here = [piece for piece in cut.pieces if piece.sheet == sheet]
        assert sum(map(signed_area, outlines)) == pytest.approx(1e6 * sum(piece.area for piece in here), rel=1e-12)
        assert np.concatenate(outlines).min() >= 0 and (np.concatenate(outlines).max(axis=0) <= 1e3 * np.array(SHEET)).all()
        assert {piece.label for piece in here} <= set(texts)
    (packed,) = write_patterns(tmp_path / "cut.zip", cut)
    with zipfile.ZipFile(packed) as archive:
        assert sorted(archive.namelist()) == sorted([*(path.name for path in paths), "cut.list.csv", "cut.plan.dxf"])
    with pytest.raises(CGCError, match="there is no sheet 99"):
        draw_sheets(cut, sheet=99)


def test_lengths_are_millimetres_in_any_unit():
    assert in_mm((3.0, 1.5), None) == in_mm((3000.0, 1500.0), "Millimeters") == "3000 x 1500 mm"
    assert in_mm([1.0], "Inches") == "25.4 mm" and in_square_metres(1e4, "Centimeters") == "1.000"


def test_pieces_on_a_sheet_do_not_overlap(cut):
    shapely = pytest.importorskip("shapely")
    for sheet in range(cut.sheets):
        own = [shapely.Polygon(piece.loops[0].points) for piece in cut.pieces if piece.sheet == sheet]
        together = shapely.union_all(own).area
        assert together == pytest.approx(sum(polygon.area for polygon in own), rel=1e-9)


def test_unrolling_does_not_depend_on_where_a_surface_stands(cut):
    turn = np.linalg.qr(np.array([[1.0, 2.0, 0.5], [0.3, -1.0, 2.0], [2.0, 0.1, 1.0]]))[0]
    turn *= np.sign(np.linalg.det(turn))
    moved = unroll(cut.problem.with_vertices(cut.problem.vertices @ turn.T + [300.0, -20.0, 7.0]), rough=True)
    still = unroll(cut.problem, rough=True)
    assert [piece.area for piece in moved.pieces] == pytest.approx([piece.area for piece in still.pieces], rel=1e-11)


def irregular_ring(bottom=4.0, top=2.0, height=3.0) -> CGCProblem:
    """Return a frustum of a pyramid on a square, its four sides, which are `height` high, of random triangles."""
    rng = np.random.default_rng(4)
    step = 0.25

    def half(z):
        return 0.5 * (bottom + (top - bottom) * z / height)

    points = [(side * half(z), z) for z in np.linspace(0.0, height, 14) for side in (-1, 1)]
    points += [(x * half(z), z) for z, count in ((0.0, 16), (height, 8)) for x in np.linspace(-1.0, 1.0, count + 1)[1:-1]]
    while len(points) < 200:
        x, z = rng.uniform(-2.0, 2.0), rng.uniform(0.6 * step, height - 0.6 * step)
        if abs(x) < half(z) - 0.6 * step and np.linalg.norm(np.array(points) - (x, z), axis=1).min() > 0.5 * step:
            points.append((x, z))
    plan = np.array(points)
    corners = Delaunay(plan).simplices
    ahead, back = plan[corners[:, 1]] - plan[corners[:, 0]], plan[corners[:, 2]] - plan[corners[:, 0]]
    double = ahead[:, 0] * back[:, 1] - ahead[:, 1] * back[:, 0]
    corners = np.where((double < 0)[:, None], corners[:, ::-1], corners)[np.abs(double) > 1e-9]
    out, up = 0.5 * (bottom - top) / height, (1.0 - (0.5 * (bottom - top) / height) ** 2) ** 0.5
    wall = np.column_stack([plan[:, 0], -0.5 * bottom + out * plan[:, 1], up * plan[:, 1]])
    turns = [np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]]) for c, s in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    space = np.vstack([wall @ turn.T for turn in turns])
    faces = np.vstack([corners + k * len(wall) for k in range(4)])
    _, first, same = np.unique(np.round(space, 9), axis=0, return_index=True, return_inverse=True)
    return CGCProblem(space[first], same.ravel()[faces]).with_targets(0.0)


def test_the_seam_of_an_irregular_ring_is_straight_through_its_faces(folded):
    problem = folded.problem
    (seam,) = folded.seams
    names = folded.patchwork.names
    assert (names[seam.nodes[[0, -1]]] < len(problem.vertices)).all()
    assert names[seam.nodes].max() >= len(problem.vertices) and len(np.unique(names)) == len(names)
    for side in seam.sides:
        along = (side[-1] - side[0]) / np.linalg.norm(side[-1] - side[0])
        assert np.abs((side - side[0]) @ [-along[1], along[0]]).max() < 0.01 * 0.3
    # As short as the way straight up, but for where it has to begin and end at vertices.
    assert 3.0 <= seam.length < 3.0 * 1.01
    assert folded.seam_mismatch < 1e-12 and folded.unrollings[0].gap < 1e-11 and folded.unrollings[0].edge_error < 1e-11
    assert folded.area == pytest.approx(36.0, rel=1e-12) and folded.area_in_space == pytest.approx(36.0, rel=1e-12)
    within = unroll(problem, SHEET, rulings=0, rough=True)
    assert within.area == pytest.approx(36.0, rel=1e-12) and within.seam_mismatch < 1e-12


@pytest.mark.filterwarnings("error")
def test_a_flat_surface_with_a_hole_needs_no_seam():
    vertices, faces = grid(6, 2.0)
    middle = vertices[faces].mean(axis=1)
    faces = faces[np.abs(middle[:, :2] - 1.0).max(axis=1) > 0.34]
    patterns = unroll(CGCProblem(vertices, faces).with_targets(0.0))
    assert len(patterns.pieces) == 1 and not patterns.seams
    assert len(patterns.pieces[0].loops) == 2
    assert patterns.area == pytest.approx(face_areas(vertices, faces).sum(), rel=1e-13)


def test_rulings_of_a_cone_are_straight_and_lie_on_their_pieces(rolled):
    assert rolled.straightness[0].median < 1e-3
    assert rolled.rulings
    for ruling in rolled.rulings:
        outline = rolled.pieces[ruling.piece].loops[0].points
        assert (ruling.points >= outline.min(axis=0) - 1e-9).all() and (ruling.points <= outline.max(axis=0) + 1e-9).all()


@pytest.mark.parametrize("suffix", [".dxf", ".svg", ".csv", ".3dm"])
def test_every_format_holds_the_pieces(cut, suffix, tmp_path):
    path = tmp_path / f"cut{suffix}"
    write_patterns(path, cut)
    if suffix == ".csv":
        rows, _ = rows_and_notes(path.open())
        assert {row["piece"] for row in rows} == {piece.label for piece in cut.pieces}
        assert max(abs(float(row["length in space in mm"]) / float(row["length in plane in mm"]) - 1) for row in rows) < 1e-11
        assert {row["seam"] for row in rows} - {""} == {str(seam.number) for seam in cut.seams}
        return
    outlines, texts = READERS[suffix](path)
    # Drawings are in millimetres, .3dm files in the units of the surface.
    assert sum(map(signed_area, outlines)) == pytest.approx(cut.area * (1.0 if suffix == ".3dm" else 1e6), rel=1e-12)
    assert {piece.label for piece in cut.pieces} <= set(texts)


def read_dxf(path):
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.readfile(path)
    assert not document.audit().errors
    space = document.modelspace()
    lines = [np.array([point[:2] for point in line.get_points()]) for line in space.query('LWPOLYLINE[layer=="CUT"]')]
    # It opens on all that there is.
    low, high = np.array([document.header["$EXTMIN"], document.header["$EXTMAX"]])[:, :2]
    view = document.viewports.get("*Active")[0].dxf
    everything = np.vstack([list(line.vertices()) for line in space.query("LWPOLYLINE")])
    assert (low <= everything.min(axis=0) + 1e-9).all() and (everything.max(axis=0) <= high + 1e-9).all()
    assert np.allclose(tuple(view.center)[:2], 0.5 * (low + high)) and max(high - low) < view.height < 1.2 * max(high - low)
    return lines, [text.dxf.text for text in space.query("TEXT")]


def read_svg(path):
    space = {"svg": "http://www.w3.org/2000/svg"}
    root = ElementTree.parse(path).getroot()
    lines = []
    for polygon in root.findall(".//svg:g[@id='CUT']/svg:polygon", space):
        lines.append(np.array([[float(x) for x in pair.split(",")] for pair in polygon.get("points").split()]) * [1, -1])
    return lines, [text.text for text in root.findall(".//svg:text", space)]


def read_layers(path):
    from compas_cgc.io.rhino.archive import list_items
    from compas_cgc.io.rhino.archive import read_archive

    items = list_items(read_archive(path))
    lines = [item.geometry.TryGetPolyline() for item in items if item.layer == "CGC Patterns::Cut"]
    return [np.array([(p.X, p.Y) for p in line])[:-1] for line in lines], [item.geometry.Text for item in items if item.kind == "text dot"]


READERS = {".dxf": read_dxf, ".svg": read_svg, ".3dm": read_layers}


def test_marks_stand_at_the_same_nodes_on_both_sides(cut):
    drawing = draw_sheets(cut)
    marks = [line for line in drawing.lines if line.layer == "MARK"]
    # Where two seams meet on a straight side, only this side has a tick, at a node of its outline.
    joints = 0
    for number, piece in enumerate(cut.pieces):
        ends = np.concatenate([seam.nodes[[0, -1]] for seam in cut.seams for each in seam.pieces if each == number])
        for loop in piece.loops:
            before, after = np.roll(loop.points, 1, axis=0) - loop.points, np.roll(loop.points, -1, axis=0) - loop.points
            cosine = (before * after).sum(axis=1) / np.linalg.norm(before, axis=1) / np.linalg.norm(after, axis=1)
            joints += sum((ends == node).sum() > 1 and turn < -np.cos(np.radians(30.0)) for node, turn in zip(loop.nodes, cosine))
    starts = np.array([line.points[0] for line in marks])
    assert 0 < joints <= len(marks) - 2 * len(cut.seams) and (len(marks) - joints) % 2 == 0
    outlines = np.concatenate([line.points for line in drawing.lines if line.layer == "CUT"])
    assert (np.linalg.norm(starts[:joints, None] - outlines, axis=2).min(axis=1) < 1e-9).all()
    assert sum(text.layer == "SEAM" for text in drawing.texts) == 2 * len(cut.seams)


def test_no_text_lies_over_marks_and_outlines(cut):
    drawing = draw_sheets(cut)
    ends = [np.vstack([line.points, line.points[:1]]) for line in drawing.lines if line.layer in ("MARK", "CUT")]
    share = np.linspace(0.0, 1.0, 41)[:, None]
    along = np.vstack([a + share * (b - a) for points in ends for a, b in zip(points[:-1], points[1:])])
    texts = [text for text in drawing.texts if text.layer in ("NODE", "SEAM")]
    hit = 0
    for text in texts:
        box = 0.5 * text.height * np.array([0.6 * len(text.text), 1.0])
        hit += bool((np.abs(along - text.place) < box).all(axis=1).any())
    # In the narrowest corners there is no room beside both lines.
    assert hit < 0.02 * len(texts)


def test_sheets_say_what_lies_on_them_and_labels_stand_out(cut, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    write_patterns(tmp_path / "cut.dxf", cut)
    document = ezdxf.readfile(tmp_path / "cut.dxf")
    titles = [text.dxf.text for text in document.modelspace().query('TEXT[layer=="SHEET"]')]
    assert len(titles) == cut.sheets and titles[0].startswith(f"sheet 1 of {cut.sheets}, 3000 x 1500 mm: ")
    told = [label for title in titles for label in title.split(": ")[1].split(";")[0].split(", ")]
    assert sorted(told) == sorted(piece.label for piece in cut.pieces)
    # Black on black: on dark screens nobody saw the labels.
    label = document.layers.get("LABEL")
    assert label.dxf.color == 7 and not label.dxf.hasattr("true_color")


def test_edges_of_the_mesh_are_no_folds_where_a_surface_is_rolled(rolled, folded, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    folds = {"FOLD_UP", "FOLD_DOWN"}
    write_patterns(tmp_path / "rolled.dxf", rolled)
    layers = {layer.dxf.name for layer in ezdxf.readfile(tmp_path / "rolled.dxf").layers}
    assert not layers & folds and {row[7] for row in cut_list(rolled)} == {0}
    drawn = [line for line in draw_sheets(folded).lines if line.layer in folds]
    assert len(drawn) == sum(row[7] for row in cut_list(folded)) > 0


@pytest.mark.parametrize("suffix", [".dxf", ".svg", ".plan.dxf", ".plan.svg"])
def test_the_legend_explains_every_layer_of_a_drawing(cut, suffix, tmp_path):
    path = tmp_path / f"cut{suffix}"
    write_patterns(path, cut)
    if suffix.endswith(".dxf"):
        space = pytest.importorskip("ezdxf").readfile(path).modelspace()
        layers, legend = {item.dxf.layer for item in space}, [text.dxf.text for text in space.query('TEXT[layer=="LEGEND"]')]
    else:
        svg = "{http://www.w3.org/2000/svg}"
        groups = [group for group in ElementTree.parse(path).getroot().findall(f".//{svg}g") if len(group)]
        layers = {group.get("id") for group in groups}
        legend = [text.text for group in groups if group.get("id") == "LEGEND" for text in group if text.text]
    explained = {line.split(":")[0] for line in legend}
    assert {"OUTLINE"} <= layers or {"CUT", "RULING", "MARK", "SEAM", "NODE"} <= layers
    assert layers - {"LEGEND"} - ({"SHEET"} if "plan" in suffix else set()) <= explained
    assert any(re.fullmatch(r"[1-9][0-9]* mm", line) for line in legend), "the scale bar has the unit of all dimensions"


def test_a_vault_of_four_regions_lies_on_few_sheets():
    assert unroll(vault(), SHEET).sheets <= 20


def test_sheets_and_cut_list_state_material_and_thickness(tmp_path):
    own = unroll(vault(8), SHEET, rough=True, regions=[0], rulings=0, material="birch <3 & more>", thickness=12.0)
    titles = [text.text for text in draw_sheets(own).texts if text.layer == "SHEET"]
    assert len(titles) == own.sheets and all(", birch <3 & more>, 12 mm thick: " in title for title in titles)
    assert {row[-2:] for row in cut_list(own)} == {("birch <3 & more>", "12")} and "birch <3 & more>, 12 mm thick" in own.summary()
    write_patterns(tmp_path / "cut.svg", own)
    assert any("birch <3 & more>" in text for text in read_svg(tmp_path / "cut.svg")[1])
    with pytest.raises(CGCError, match="the material must be a name"):
        unroll(vault(), SHEET, rough=True, material=3)  # type: ignore[arg-type]


def test_radii_at_rulings_lie_within_their_pieces_apart_from_each_other_and_from_names(cut):
    shapely = pytest.importorskip("shapely")
    drawing = draw_sheets(cut)
    texts = [text for text in drawing.texts if text.layer in ("RULING", "LABEL")]
    boxes = [shapely.box(*(_around(text)[0]), *(_around(text)[1])) for text in texts]
    pieces = [shapely.Polygon(line.points) for line in drawing.lines if line.layer == "CUT"]
    radii = [box for box, text in zip(boxes, texts) if text.layer == "RULING"]
    assert len(radii) > 0.8 * len(cut.rulings)
    assert all(any(piece.contains(box) for piece in pieces) for box in radii)
    tree = shapely.STRtree(boxes)
    assert all(boxes[i].intersection(boxes[j]).area < 1e-12 for i, j in tree.query(boxes).T.tolist() if i != j)


def _around(text):
    half = 0.5 * text.height * np.array([LETTER_WIDTH * len(text.text), 1.0])
    return text.place - half, text.place + half


@pytest.mark.parametrize("K", [0.02, 0.0])
def test_only_panels_larger_than_a_sheet_are_cut(K):
    problem = CGCProblem(*revolved_patch(24, K)).with_supports("boundary").with_targets(K) if K else vault()
    own = panels(problem, count=6)
    whole, ample = (unroll(problem, (50.0, 50.0), panels=own, whole=kept, rough=True, rulings=0) for kept in (True, False))
    assert [piece.label for piece in ample.pieces] == [piece.label for piece in whole.pieces] and len(own) > 2
    assert [piece.area for piece in ample.pieces] == [piece.area for piece in whole.pieces]
    longest = max(best_box(piece.loops[0].points, (np.inf, np.inf)).length for piece in whole.pieces)
    cut = unroll(problem, (0.8 * longest, 50.0), panels=own, whole=False, rough=True, rulings=0)
    assert len(own) <= len(cut.pieces) <= 2 * len(own) and cut.area == pytest.approx(whole.area, rel=1e-3)


def test_the_table_of_edges_calls_edges_of_rolled_pieces_inner(cut, folded):
    kinds = {row[3] for row in edge_table(cut)}
    assert "inner" in kinds and "fold" not in kinds
    assert "fold" in {row[3] for row in edge_table(folded)}


@pytest.mark.parametrize("turned", [False, True])
def test_rulings_state_the_radius_and_the_side_of_bending(turned):
    problem = vault()
    if turned:
        problem = problem.with_vertices(problem.vertices * [1.0, 1.0, -1.0])
    own = unroll(problem, rough=True)
    texts = [text.text for text in draw_sheets(own).texts if text.layer == "RULING"]
    assert len(texts) == len(own.rulings) > 10
    # Both barrels have a radius of 5 m; at the ends of a region fits are one-sided.
    radii = np.array([float(text.split()[1]) for text in texts])
    assert np.median(np.abs(radii / 5000.0 - 1.0)) < 0.01 and np.abs(radii / 5000.0 - 1.0).max() < 0.1
    side = "towards" if turned else "away"
    assert {text.split()[2] for text in texts} == {side} == {row[-3] for row in cut_list(own) if row[-3]}


def test_sharp_corners_and_pieces_on_the_edge_of_a_sheet_are_named(cut):
    needle = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 0.3, 0.0]])
    own = unroll(CGCProblem(needle, np.array([[0, 1, 2]])).with_targets(0.0), (4.0, 4.0), rough=True)
    angle = np.degrees(np.arctan2(0.3, 3.0))
    assert f"corners sharper than 15 degrees: A1 ({angle:.1f})" in own.summary() and cut_list(own)[0][-6] == f"{angle:.1f}"
    # Contours in the middle of the kerf are bevelled at sharp corners.
    sawn = unroll(CGCProblem(needle, np.array([[0, 1, 2]])).with_targets(0.0), (4.0, 4.0), rough=True, kerf=0.002)
    assert f"A1 ({angle:.1f})" in sawn.summary()
    thin = unroll(CGCProblem(needle * [1.0, 0.05, 1.0], np.array([[0, 1, 2]])).with_targets(0.0), (4.0, 4.0), rough=True)
    assert [text.text for text in draw_sheets(thin).texts if text.layer == "LABEL"] == ["A1"]
    assert "corners sharper" not in cut.summary() or min(np.degrees(sharpest_corner(piece)) for piece in cut.pieces) < 15.0
    assert "lie on the edge of their sheet" in cut.summary() and "yes" in {row[-5] for row in cut_list(cut)}
    free = unroll(vault(8), SHEET, rough=True, regions=[0], margin=0.01, rulings=0)
    assert "on the edge of" not in free.summary() and {row[-5] for row in cut_list(free)} == {""}
    titles = [text.text for text in draw_sheets(free).texts if text.layer == "SHEET"]
    assert titles and not any("not trimmed" in title for title in titles)


# ----------------------------------------------------------------------
# K other than 0
# ----------------------------------------------------------------------


@pytest.mark.parametrize("width", [5.0, 2.5, 1.25])
def test_strain_of_flattened_panels_follows_the_rule(width):
    """The width by the rule for the strain that comes out, within 10 % of the panel's."""
    vertices, faces = grid(16, width)
    vertices[:, :2] -= width / 2
    vertices[:, 2] = np.sqrt(100.0 - vertices[:, 0] ** 2 - vertices[:, 1] ** 2)
    found = flatten(vertices, faces)
    assert widest_panel(0.01, found.largest) == pytest.approx(width, rel=0.1)
    assert found.strains.max() == pytest.approx(-found.strains.min(), rel=1e-9)


@pytest.mark.parametrize("length, width", [(5.0, 5.0), (2.5, 2.5), (1.25, 1.25), (3.0, 1.5), (4.5, 1.5), (10.0, 1.0)])
@pytest.mark.parametrize("K", [0.01, -0.01])
def test_strain_of_rectangles_is_that_of_the_best_conformal_map(K, length, width):
    """The strain by the torsion function of the panel, within 5 %."""
    found = flatten(*rectangle(length, width, K))
    assert found.largest == pytest.approx(strain_of_width(K, width, length / width), rel=0.05)
    assert found.strains.max() == pytest.approx(-found.strains.min(), rel=1e-9)


def test_constants_of_the_rule():
    """Twice the inverse of the largest torsion function, from tables: 0.07367 and 0.11387 of a square and of two, 1/8 of a strip."""
    assert [flattening_constant(aspect) for aspect in (1.0, 2.0, 0.5, 50.0)] == pytest.approx([27.15, 17.56, 17.56, 16.0], rel=1e-3)
    assert widest_panel(0.01, 0.002) == pytest.approx((24 * 0.002 / 0.01) ** 0.5) and widest_panel(0.0, 0.002, 2.0) == np.inf
    with pytest.raises(ValueError, match="aspect of a panel"):
        flattening_constant(0.0)


def test_the_cut_list_states_bending_strain_and_seams_of_curved_pieces():
    K = 0.04
    problem = CGCProblem(*revolved_patch(20, K, radius=3.0)).with_supports("boundary").with_targets(K)
    own = unroll(problem, SHEET)
    rows, _ = rows_and_notes(cut_list_text(own).splitlines())
    # The smaller principal radius is that of the parallels, of 3 m along the middle and less towards the ends.
    assert {row["bends"] for row in rows} == {"away"}
    radii = [float(row["least bending radius in mm"]) for row in rows]
    assert 2000.0 < min(radii) <= max(radii) < 3000.0 * 1.01
    saddle = unroll(CGCProblem(*revolved_patch(20, -K)).with_supports("boundary").with_targets(-K), SHEET)
    assert {row["bends"] for row in rows_and_notes(cut_list_text(saddle).splitlines())[0]} == {"away towards"}
    strains = {piece.label: 100 * piece.strain for piece in own.pieces}
    assert {row["piece"]: float(row["strain in %"]) for row in rows} == pytest.approx(strains, abs=6e-4)
    for row in rows:
        beside = [seam for seam in own.seams if row["piece"] in [own.pieces[k].label for k in seam.pieces]]
        difference = {seam.number: 1000 * abs(seam.lengths[0] - seam.lengths[1]) for seam in beside}
        assert float(row["seam difference in mm"]) == pytest.approx(max(difference.values()), abs=6e-3)
        assert difference[int(row["at seam"])] == max(difference.values())
    # Pieces of another division than the panels of a mould report have other names.
    assert not {piece.label for piece in own.pieces} & {panel.name for panel in panels(problem, 1.5)}
    given = unroll(problem, (4.0, 4.0), panels=panels(problem, 1.5))
    assert {piece.label for piece in given.pieces} == {panel.name for panel in panels(problem, 1.5)}


def test_a_dome_is_cut_until_the_strain_is_small_enough():
    patterns = unroll(CGCProblem(*revolved_patch(12, 0.02)).with_supports("boundary").with_targets(0.02), SHEET, strain=0.002)
    assert patterns.largest_strain <= 0.002
    assert all((np.concatenate([loop.points for loop in piece.loops]).max(axis=0) <= SHEET).all() for piece in patterns.pieces)
    assert patterns.area == pytest.approx(patterns.area_in_space, rel=2e-3)


def test_without_a_sheet_strain_cuts_no_strips():
    patterns = unroll(CGCProblem(*revolved_patch(16, 0.02)).with_supports("boundary").with_targets(0.02), strain=0.002)
    assert patterns.largest_strain <= 0.002
    sizes = [np.ptp(np.concatenate([loop.points for loop in piece.loops]), axis=0) for piece in patterns.pieces]
    assert len(sizes) > 4 and all(size.min() > 0.3 * size.max() for size in sizes)


def test_strips_are_cut_one_by_one_where_the_lines_of_a_grid_converge():
    """A trapezoid of a sphere: columns of a grid become narrow along its short side and fill few sheets."""
    vertices, faces = grid(20, 10.0)
    vertices[:, :2] -= 5.0
    vertices[:, 0] *= 0.7 - 0.06 * vertices[:, 1]
    vertices[:, 2] = np.sqrt(144.0 - vertices[:, 0] ** 2 - vertices[:, 1] ** 2)
    patterns = unroll(CGCProblem(vertices, faces).with_supports("boundary").with_targets(1.0 / 144.0), SHEET, rough=True)
    assert patterns.sheets <= 24 and len(patterns.pieces) <= 24
    assert patterns.area == pytest.approx(patterns.area_in_space, rel=1e-3)


def test_a_closed_sphere_is_slit_and_cut():
    patterns = unroll(CGCProblem(*icosphere(2, 2.0)).with_targets(0.25), SHEET, strain=0.02, rough=True)
    assert patterns.largest_strain <= 0.02
    assert patterns.area == pytest.approx(patterns.area_in_space, rel=0.02)


# ----------------------------------------------------------------------
# What is refused
# ----------------------------------------------------------------------


def test_panels_that_are_kept_whole_are_refused_where_a_sheet_has_no_room_for_them(cut):
    single = unroll(vault(), rough=True)
    assert len(cut.pieces) > len(single.pieces) == 4
    box = best_box(single.pieces[0].loops[0].points, SHEET)
    size = in_mm((box.length, box.width), None)
    with pytest.raises(CGCError, match=f"the panel of region 0 at vertex [0-9]+ needs {size}, more than a sheet of 3000 x 1500 mm; use"):
        unroll(vault(), SHEET, rough=True, whole=True)
    enough = (box.length + 1.0, box.length + 1.0)
    assert len(unroll(vault(), enough, rough=True, whole=True).pieces) == len(single.pieces)
    with pytest.raises(CGCError, match="more than a sheet of .*usable: .*; use larger sheets, divide it by a crease or a seam"):
        unroll(vault(), enough, rough=True, whole=True, margin=0.5 * enough[0] - 1.0)
    with pytest.raises(CGCError, match="exceeds the allowed strain; divide it"):
        unroll(CGCProblem(*icosphere(2, 2.0)).with_targets(0.25), strain=0.02, rough=True, whole=True)


def test_panels_between_seams_that_are_given_are_kept_whole_unless_they_may_be_cut():
    around = ring()
    path = unroll(around).seams[0].nodes.tolist()
    with pytest.raises(CGCError, match="the panel of region 0 .* more than a sheet of 3000 x 1500 mm"):
        unroll(around, SHEET, seams=[path])
    assert len(unroll(around, SHEET, seams=[path], whole=False).pieces) > 1
    with pytest.raises(CGCError, match="whole must be true or false, not 3"):
        unroll(around, SHEET, whole=3)  # type: ignore[arg-type]


def crumpled() -> CGCProblem:
    problem = ring(8, 30)
    rng = np.random.default_rng(1)
    return problem.with_vertices(problem.vertices + 0.05 * rng.standard_normal(problem.vertices.shape))


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: unroll(crumpled()), "the surface is rough"),
        (lambda: unroll(crumpled(), rough=True), "does not unroll: gaps of up to"),
        (lambda: unroll(ring(), seams=[[0, 1]]), "none of the given seams opens"),
        (lambda: unroll(ring(), seams=[[0, 200]]), "does not follow an edge"),
        (lambda: unroll(ring(), (0.0, 1.0)), "the length and width of a sheet must be positive"),
        (lambda: unroll(ring(), 3.0), "a sheet must have a length and a width, such as .3.0, 1.5., not 3.0"),
        (lambda: unroll(ring(), (0.004, 0.003)), "use larger sheets"),
        (lambda: unroll(ring(), (3000.0, 1500.0)), "far larger than the surface.* such as 3000x1500mm"),
        (lambda: unroll(ring(), SHEET, spacing=-0.1), "spacing between pieces must be at least 0"),
        (lambda: unroll(ring(), SHEET, spacing=20.0), "a spacing of 20 is too large for a sheet of 3 x 1.5; .* such as 0.015"),
        (
            lambda: unroll(ring(), allowance=30.0),
            "the allowance of 30 units of the model is larger than the surface, whose size is [0-9.]+",
        ),
        (lambda: unroll(ring(), SHEET, rulings=1e-5), "a spacing of 1e-05 would give .* more than 2000 curves; use .* or more"),
        (lambda: unroll(CGCProblem(*grid(6, 2.0)).with_targets(0.1)), "rough because it is not solved: its total curvature is 0 %"),
        (lambda: unroll(ring(), regions=[3]), "there is no region 3"),
        (lambda: unroll(ring(), strain=-1.0), "must be positive"),
        (lambda: unroll(CGCProblem(*icosphere(1, 2.0)).with_targets(0.25), strain=1e-4, rough=True), "smaller than its mesh edges"),
        (lambda: flatten(*icosphere(1)), "0 boundary loops"),
    ],
    ids=[
        "rough",
        "not flat",
        "a hole",
        "no edge",
        "no sheet",
        "a number for a sheet",
        "a tiny sheet",
        "millimetres",
        "spacing",
        "spacing in millimetres",
        "allowance in millimetres",
        "rulings",
        "flat",
        "no region",
        "strain",
        "a coarse mesh",
        "closed",
    ],
)
def test_what_cannot_be_unrolled_is_refused_in_a_sentence(call, sentence):
    with pytest.raises(CGCError, match=sentence):
        call()


def test_a_rectangle_larger_than_the_sheet_is_refused():
    with pytest.raises(ValueError, match="does not fit on a sheet"):
        nest([(1.0, 1.0), (4.0, 1.0)], SHEET)


def test_a_program_that_ignores_units_reads_millimetres(cut, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    lengths = {}
    for units, code in (("mm", 4), ("m", 6), ("drawing", 6)):
        write_patterns(tmp_path / f"{units}.dxf", cut, units=units)
        document = ezdxf.readfile(tmp_path / f"{units}.dxf")
        assert document.header["$INSUNITS"] == code
        outline = document.modelspace().query('LWPOLYLINE[layer=="CUT"]')[0]
        lengths[units] = np.ptp([point[0] for point in outline.get_points()])
    own = np.ptp(cut.pieces[0].loops[0].points[:, 0])
    assert lengths["mm"] == pytest.approx(1000.0 * own, rel=1e-12) and lengths["m"] == lengths["drawing"] == pytest.approx(own, rel=1e-12)
    with pytest.raises(CGCError, match="files can be in mm, cm, m, in, ft or drawing units"):
        write_patterns(tmp_path / "other.dxf", cut, units="miles")


def test_labels_lie_inside_their_pieces(cut):
    shapely = pytest.importorskip("shapely")
    drawing = draw_sheets(cut)
    labels = {text.text: text for text in drawing.texts if text.layer == "LABEL"}
    cuts = [shapely.Polygon(line.points) for line in drawing.lines if line.layer == "CUT"]
    for label in labels.values():
        half = 0.5 * label.height * np.array([0.8 * len(label.text), 1.0])
        assert any(own.contains(shapely.box(*(label.place - half), *(label.place + half))) for own in cuts)


def test_numbers_of_nodes_are_clear_of_all_other_texts():
    vault = solve(read(get("vault.3dm")))
    drawing = draw_sheets(unroll(vault, (3.0, 1.5), material="plywood", thickness=12))
    boxes = {layer: [text_box(own.text, own.place, own.height) for own in drawing.texts if own.layer == layer] for layer in TEXTS}
    others = [box for layer in TEXTS[1:] for box in boxes[layer]]
    assert len(boxes["NODE"]) > 100 and not any(overlap(node, other) for node in boxes["NODE"] for other in others)
    legend = " ".join(own.text for own in drawing.texts if own.layer == "LEGEND")
    assert "free: 15 mm between pieces" in legend and "product of the two principal curvatures" in legend
    # A workshop with the sheets and the cut list alone knows what to do with every line.
    assert "straight from point to point, not as a smooth curve" in legend and "to engrave or draw with its text, not to cut" in legend
    assert "the edge table (the separate file -o NAME.csv)" in legend and "table of edges" not in legend


def test_the_cut_list_names_pieces_that_no_ruling_crosses():
    own = unroll(solve(read(get("vault.3dm"))), (3.0, 1.5), margin=0.02)
    rows, notes = rows_and_notes(cut_list_text(own).splitlines())
    ruled = {own.pieces[ruling.piece].label for ruling in own.rulings}
    by_hand = {row["piece"] for row in rows if row["bends"] == "as neighbours"}
    assert (
        by_hand
        == {row["piece"] for row in rows if not row["least bending radius in mm"]}
        == {row["piece"] for row in rows} - ruled
        != set()
    )
    assert "as neighbours: no radius is known" in " ".join(notes)
    legend = " ".join(own.text for own in draw_sheets(own).texts if own.layer == "LEGEND")
    assert "by hand until its seams meet those of its neighbours" in legend


def test_joints_fill_sheets_and_short_seams_are_moved_or_named():
    vault = solve(read(get("vault.3dm")))
    chosen, plain = (unroll(vault, (3.0, 1.5), spacing=0.0, rulings=0, shortest=shortest) for shortest in (100.0, 0.0))
    assert chosen.sheets <= 15 and plain.sheets <= 15
    assert min(seam.length for seam in chosen.seams) >= 0.1 and "shorter than" not in chosen.summary()
    short = [seam for seam in plain.seams if seam.length < 0.1]
    assert short and all(f"seam {seam.number} of " in plain.summary() for seam in short)
    assert chosen.area == pytest.approx(chosen.area_in_space, rel=1e-12)
