"""Joints: one design for moulds and patterns, aligned across creases, symmetric, with given widths and long seams."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

import compas_cgc
from compas_cgc import CGCError
from compas_cgc import CGCMesh
from compas_cgc import CGCProblem
from compas_cgc import solve
from compas_cgc.discrete import edge_faces
from compas_cgc.discrete import face_areas
from compas_cgc.fabrication import curve_net
from compas_cgc.fabrication import moulds
from compas_cgc.fabrication import panels
from compas_cgc.fabrication import unroll
from compas_cgc.fabrication.assembly import draw_plan
from compas_cgc.fabrication.drawing import text_box
from compas_cgc.fabrication.leaders import READABLE
from compas_cgc.fabrication.panel_seams import panel_seams
from compas_cgc.fabrication.quarter_turn import turns_onto_itself
from compas_cgc.fabrication.sheet_drawing import MARK_LENGTH
from compas_cgc.fabrication.sheet_drawing import draw_sheets

from ..support.constant_curvature import revolved_patch
from ..support.roofs import nine_regions
from ..support.shapes import grid


@pytest.fixture(scope="module")
def roof():
    return compas_cgc.solve(nine_regions(12), method="projection", settings={"measure": "exact"}).problem


def middles(problem, found):
    """Return the area and the centroid of every panel (p, 4)."""
    cut = found[0].cut
    V, F = (problem.vertices, problem.faces) if cut is None else (cut.vertices, cut.faces)
    areas, rows = face_areas(V, F), []
    for panel in found:
        own = areas[panel.faces]
        rows.append([own.sum(), *(own @ V[F[panel.faces]].mean(axis=1) / own.sum())])
    return np.array(rows)


@pytest.mark.parametrize("size", [1.1, 1.7, 2.3])
def test_a_fourfold_roof_has_a_fourfold_pattern(size):
    # The diagonals of the squares make the solved surface slightly unsymmetric; the drawing is exactly fourfold.
    flat = nine_regions(12)
    found = middles(flat, panels(flat, size))
    middle = 0.5 * (flat.vertices.min(axis=0) + flat.vertices.max(axis=0))[:2]
    for turn in ([[0, -1], [1, 0]], [[-1, 0], [0, 1]]):
        moved = np.column_stack([found[:, 0], (found[:, 1:3] - middle) @ np.array(turn).T + middle, found[:, 3]])
        assert np.linalg.norm(moved[:, None] - found, axis=2).min(axis=1).max() < 1e-9


@pytest.mark.parametrize("size", [1.1, 1.7, 2.3])
def test_joints_continue_across_creases(roof, size):
    found = panels(roof, size)
    seams = panel_seams(roof, found)
    region = {panel.name: panel.region for panel in found}
    meeting = {}
    for seam in seams:
        if region[seam.panels[0]] != region[seam.panels[1]]:
            for one, other in (seam.panels, seam.panels[::-1]):
                meeting.setdefault((one, region[other]), []).append(other)
    # Each panel meets one panel of every region beside it.
    assert len(meeting) > 8 and max(map(len, meeting.values())) == 1
    assert min(seam.length for seam in seams) > 0.5


def test_widths_of_columns_and_rows_are_given():
    flat = CGCProblem(*grid(30, 15.0)).with_targets(0.0)
    found = panels(flat, columns=[3.0, 1.0, 2.5], rows=4.0)
    # All these lines are rows of the mesh.
    x, y = (np.unique(np.round([flat.vertices[flat.faces[own.faces]][:, :, k].min() for own in found], 9)) for k in (0, 1))
    # 15 m: the last width is repeated.
    assert x.tolist() == [0.0, 3.0, 4.0, 6.5, 9.0, 11.5, 14.0] and y.tolist() == [0.0, 4.0, 8.0, 12.0]
    with pytest.raises(CGCError, match="widths of columns and rows must be positive"):
        panels(flat, columns=[1.0, 0.0])


def test_short_seams_are_avoided_or_named():
    drawn = compas_cgc.read(compas_cgc.get("curved_crease.3dm")).to_problem().with_targets(0.005)
    problem = compas_cgc.solve(drawn, settings={"measure": "exact"}).problem
    free, kept = (panels(problem, 1.4, shortest=shortest) for shortest in (0.0, 100.0))
    assert min(seam.length for seam in panel_seams(problem, free)) < 0.1
    assert min(seam.length for seam in panel_seams(problem, kept)) >= 0.1
    assert "seams shorter than 100 mm" not in str(moulds(problem, kept))
    named = [seam for seam in panel_seams(problem, free) if seam.length < 0.1]
    assert all("/".join(seam.panels) in str(moulds(problem, free)) for seam in named)


def test_panels_are_the_pieces_of_patterns(roof):
    found = panels(roof, 1.7)
    patterns = unroll(roof, (6.0, 3.0), panels=found)
    assert [(piece.label, piece.region) for piece in patterns.pieces] == [(panel.name, panel.region) for panel in found]
    assert np.array([piece.area_in_space for piece in patterns.pieces]) == pytest.approx(middles(roof, found)[:, 0], rel=1e-9)
    kinds = {seam.kind for seam in patterns.seams}
    assert kinds == {"cut", "crease"}
    cuts = sum(seam.length for seam in patterns.seams if seam.kind == "crease")
    edges = edge_faces(roof.faces)
    label = roof.regions()
    inner = edges[edges[:, 3] >= 0]
    across = inner[label[inner[:, 2]] != label[inner[:, 3]], :2]
    assert cuts == pytest.approx(np.linalg.norm(roof.vertices[across[:, 0]] - roof.vertices[across[:, 1]], axis=1).sum())
    with pytest.raises(CGCError, match="more than a sheet of 1500 x 1000 mm"):
        unroll(roof, (1.5, 1.0), panels=found)
    with pytest.raises(CGCError, match="do not cover the surface"):
        unroll(roof, (6.0, 3.0), panels=found[:-1])


def test_sheets_of_a_curved_roof_are_cut_along_one_grid(roof):
    """Joints in neighbouring regions meet, so that creases have no short seams either."""
    patterns = unroll(roof, (3.0, 1.5))
    assert min(seam.length for seam in patterns.seams) >= 0.1
    assert "seams shorter than" not in str(patterns)
    # As many pieces in each of the corner regions, and in each of the regions at the sides.
    count = np.bincount([piece.region for piece in patterns.pieces])
    assert len(set(count[[0, 2, 6, 8]].tolist())) == 1 and len(set(count[[1, 3, 5, 7]].tolist())) == 1


def test_sheets_lie_alike_in_neighbouring_regions_whose_coordinates_run_differently():
    """The halves of a hexagon have their first coordinates along and across the crease between them."""
    corners = [(6.0 * np.cos(turn), 6.0 * np.sin(turn), 0.0) for turn in np.radians(40.0 + 60.0 * np.arange(6))]
    mesh = CGCMesh.from_outline(corners, 0.5, creases=[[corners[0], corners[3]]])
    mesh.set_supports([vertex for vertex in mesh.vertices() if np.hypot(*mesh.vertex_coordinates(vertex)[:2]) > 5.99])
    mesh.set_target(0.012)
    patterns = unroll(solve(mesh), (3.0, 1.5))
    counts = np.bincount([piece.region for piece in patterns.pieces])
    assert counts[0] == counts[1]


def test_panels_of_a_vault_unroll_without_strain():
    vault = compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm")))
    patterns = unroll(vault, (3.0, 1.5), panels=panels(vault, 1.2))
    assert abs(patterns.area / patterns.area_in_space - 1.0) < 1e-12 and patterns.largest_strain < 1e-9


def test_panels_lie_between_the_curves_of_a_net():
    problem = CGCProblem(*revolved_patch(24, -0.02)).with_supports("boundary").with_targets(-0.02)
    net = curve_net(problem, 1.5)
    found = panels(problem, curves=net)
    assert len(found) > 10
    assert np.median(middles(problem, found)[:, 0]) < 1.5**2


QUARTER_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])


@pytest.fixture(scope="module")
def quarters():
    """A roof of 16 m on eight columns, in four quarters."""
    outline, creases = [[0, 0], [16, 0], [16, 16], [0, 16]], [[[8, 0, 0], [8, 16, 0]], [[0, 8, 0], [16, 8, 0]]]
    problem = CGCMesh.from_outline(outline, 0.8, creases=creases).to_problem()
    x, y, _ = problem.vertices.T
    held = np.isin(x, [0, 8, 16]) & np.isin(y, [0, 8, 16]) & ~((x == 8) & (y == 8))
    return solve(problem.with_supports(np.flatnonzero(held).tolist()).with_targets(0.008))


def middles_about(patterns, centre):
    """Return the middles in plan of the boxes around the pieces, from a centre."""
    own = patterns.patchwork
    boxes = [own.space[own.faces[own.piece == k]][..., :2].reshape(-1, 2) for k in range(len(patterns.pieces))]
    return np.array([0.5 * (box.min(axis=0) + box.max(axis=0)) for box in boxes]) - centre


def off_after(middles, motion):
    """Return the largest distance of moved middles from those that are there."""
    return np.linalg.norm(middles[:, None] - middles @ np.transpose(motion), axis=2).min(axis=1).max()


def test_pieces_of_a_symmetric_roof_are_symmetric_without_short_seams(quarters):
    patterns = unroll(quarters, (3.0, 1.5), allowance=0.02)
    assert all(seam.length >= 0.1 for seam in patterns.seams) and "shorter than" not in str(patterns)
    assert len({sum(piece.region == region for piece in patterns.pieces) for region in range(4)}) == 1
    middles = middles_about(patterns, 8.0)
    # The triangles are not symmetric, so that joints are about as far apart as the grid follows them.
    for motion in (np.diag([-1.0, 1.0]), np.diag([1.0, -1.0]), QUARTER_TURN):
        assert off_after(middles, motion) < 0.1


def test_strips_of_a_cloister_vault_turn_with_it():
    outline, diagonals = [[0, 0], [12, 0], [12, 12], [0, 12]], [[[0, 0, 0], [12, 12, 0]], [[0, 12, 0], [12, 0, 0]]]
    problem = CGCMesh.from_outline(outline, 1.0, creases=diagonals).to_problem()
    V = problem.vertices.copy()
    corners, middles = (cKDTree(V[:, :2]).query(at)[1] for at in (outline, [[6, 0], [12, 6], [6, 12], [0, 6]]))
    V[middles, 2] = 2.0
    vault = solve(replace(problem, vertices=V).with_supports([*corners.tolist(), *middles.tolist()]).with_targets(0.0))
    patterns = unroll(vault, (3.0, 1.5))
    assert all(seam.length >= 0.1 for seam in patterns.seams)
    assert len({sum(piece.region == region for piece in patterns.pieces) for region in range(4)}) == 1
    assert off_after(middles_about(patterns, 6.0), QUARTER_TURN) < 0.1


@pytest.mark.parametrize(
    "change, expected",
    [(lambda V: V, True), (lambda V: V * [1.0, 1.1, 1.0], False), (lambda V: V + [[0, 0, 0.3]] * (V[:, :1] > 12.0), False)],
)
def test_roofs_with_a_quarter_turn_are_found(quarters, change, expected):
    problem = quarters.problem
    assert turns_onto_itself(replace(problem, vertices=change(problem.vertices))) == expected


def test_numbers_of_short_seams_are_led_aside(quarters):
    longer = replace(quarters.problem, vertices=quarters.problem.vertices * [1.0, 1.1, 1.0])
    patterns = unroll(longer, (3.0, 1.5), allowance=0.02, shortest=0.0, rough=True)
    tiny = [seam for seam in patterns.seams if seam.length < 0.01]
    assert tiny
    drawing, plan = draw_sheets(patterns), draw_plan(patterns)
    for own, height, copies in ((drawing, 0.5 * MARK_LENGTH * 3.0, 2), (plan, 0.6 * MARK_LENGTH * 16.0, 1)):
        numbers = [text for text in own.texts if text.layer == "SEAM"]
        leaders = [line.points for line in own.lines if line.layer == "SEAM"]
        assert len(numbers) == copies * len(patterns.seams) and len(leaders) >= copies * len(tiny)
        assert min(text.height for text in numbers) >= READABLE * height
        # A leader begins at a short seam and ends at its text.
        low = patterns.patchwork.space[:, :2].min(axis=0)
        for line in leaders:
            box = min((text_box(text.text, text.place, text.height) for text in numbers), key=lambda box: _off(line[1], box))
            assert _off(line[1], box) < 1e-9
            if copies == 1:
                feet = [patterns.patchwork.space[seam.nodes][:, :2] - low for seam in patterns.seams]
                assert min(np.linalg.norm(foot - line[0], axis=1).min() for foot in feet) < 0.3


def _off(point, box):
    """Return the distance of a point from a box."""
    return float(np.linalg.norm(point - np.clip(point, *box)))
