"""Stock: sheets of several sizes, grain, and nesting of true shapes."""

from __future__ import annotations

import numpy as np
import pytest

import compas_cgc
from compas_cgc import CGCError
from compas_cgc import CGCProblem
from compas_cgc.discrete import face_areas
from compas_cgc.fabrication import draw_sheets
from compas_cgc.fabrication import panels
from compas_cgc.fabrication import unroll
from compas_cgc.fabrication.shape_nesting import nest_shapes


@pytest.fixture(scope="module")
def vault():
    return compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm"))).problem


def on_their_sheets(patterns):
    """Check that all pieces lie on their sheets and apart from each other."""
    shapely = pytest.importorskip("shapely")
    shapes = [shapely.Polygon(piece.loops[0].points, [loop.points for loop in piece.loops[1:]]) for piece in patterns.pieces]
    for piece, shape in zip(patterns.pieces, shapes):
        sheet = shapely.box(0.0, 0.0, *patterns.sheet_sizes[piece.sheet])
        assert shape.difference(sheet).area < 1e-5
    for k, one in enumerate(shapes):
        for j in range(k):
            if patterns.pieces[j].sheet == patterns.pieces[k].sheet:
                assert one.intersection(shapes[j]).area < 1e-5


def crescent(area):
    """Return a developable crescent: a parabolic barrel over a plan between two arcs."""
    along, across = 60, 10
    angle, part = (x.ravel() for x in np.meshgrid(np.linspace(-1.0, 1.0, along + 1), np.linspace(-0.5, 0.5, across + 1), indexing="ij"))
    radius = 16.0 + 8.9 * part * np.cos(np.pi * angle / 2.16)
    plan = np.column_stack([radius * np.cos(angle) - 16.0, radius * np.sin(angle)])
    a = (np.arange(along)[:, None] * (across + 1) + np.arange(across)).ravel()
    faces = np.column_stack([a, a + across + 1, a + across + 2, a, a + across + 2, a + 1]).reshape(-1, 3)
    vertices = np.column_stack([plan, 3.0 - 0.02 * plan[:, 1] ** 2])
    vertices *= (area / face_areas(vertices, faces).sum()) ** 0.5
    return compas_cgc.solve(CGCProblem(vertices, faces).with_supports("boundary").with_targets(0.0)).problem


def test_a_crescent_and_the_vault_fill_their_sheets(vault):
    pytest.importorskip("shapely")
    for surface, sheets in ((crescent(202.0), 52), (vault, 15)):
        patterns = unroll(surface, (3.0, 1.5), spacing=0.0, rulings=0)
        assert patterns.sheets <= sheets and min(seam.length for seam in patterns.seams) >= 0.1
        on_their_sheets(patterns)


@pytest.mark.parametrize(("strip", "sheets"), [({"kerf": 0.004}, 16), ({"allowance": 0.03}, 18)], ids=["kerf", "allowance"])
def test_rows_leave_room_for_the_strip_around_pieces(vault, strip, sheets):
    """Rows as wide as the sheet would be cut again for the strip: 32 sheets instead of 15 for a kerf of 4 mm."""
    pytest.importorskip("shapely")
    assert unroll(vault, (3.0, 1.5), **strip).sheets <= sheets


def test_every_sheet_is_the_smallest_that_holds_its_pieces(vault):
    found = panels(vault, 1.2)
    one, several = (unroll(vault, sheet, panels=found, rulings=0) for sheet in ((3.0, 1.5), [(1.5, 1.5), (3.0, 1.5), (2.0, 1.5)]))
    assert set(one.sheet_sizes) == {(3.0, 1.5)}
    assert several.sheets == one.sheets and len(set(several.sheet_sizes)) > 1
    assert sum(x * y for x, y in several.sheet_sizes) < sum(x * y for x, y in one.sheet_sizes)
    on_their_sheets(several)
    assert "of 3000 x 1500 mm, " in str(several)
    drawn = [np.ptp(line.points, axis=0) for line in draw_sheets(several).lines if line.layer == "SHEET"]
    assert np.allclose(drawn, several.sheet_sizes)


def test_a_grain_runs_along_the_sheets(vault):
    patterns = unroll(vault, (3.0, 1.5), grain=(1.0, 0.0), rulings=0)
    own = patterns.patchwork
    space, plane = own.space[own.faces], own.plane
    # Directions of faces along x, on the sheets; the vault is developable, so that they are nearly parallel on a piece.
    edges, flat = space[:, 1:] - space[:, :1], plane[:, 1:] - plane[:, :1]
    share = np.linalg.pinv(edges.transpose(0, 2, 1)) @ np.array([1.0, 0.0, 0.0])
    along = np.einsum("fk,fkj->fj", share, flat)
    for piece in range(len(patterns.pieces)):
        mean = along[own.piece == piece].sum(axis=0)
        assert abs(mean[1]) < 0.05 * abs(mean[0])
    on_their_sheets(patterns)
    with pytest.raises(CGCError, match="grain must be a direction in plan"):
        unroll(vault, (3.0, 1.5), grain=(0.0, 0.0))


def test_true_shapes_share_sheets_that_their_rectangles_do_not():
    pytest.importorskip("spyrrow")
    shapely = pytest.importorskip("shapely")
    triangle = np.array([[0.0, 0.0], [2.7, 0.0], [0.0, 1.3]])
    sheets, places = nest_shapes([triangle] * 4, [0, 1, 2, 3], (3.0, 1.5), 0.01)
    assert sorted(sheets) == [0, 0, 1, 1]
    shapes = []
    for angle, shift in (places[k] for k in range(4)):
        c, s = np.cos(angle), np.sin(angle)
        shapes.append(shapely.Polygon(triangle @ np.array([[c, s], [-s, c]]) + shift))
        assert shapes[-1].difference(shapely.box(0.0, 0.0, 3.0, 1.5)).area < 1e-5
    for sheet in (0, 1):
        one, other = (shape for shape, own in zip(shapes, sheets) if own == sheet)
        assert one.distance(other) > 0.01 - 1e-4


def test_a_thickness_in_metres_is_refused(vault):
    with pytest.raises(CGCError, match="a thickness of 0.006 mm is thinner than foil; give it in mm, such as 6"):
        unroll(vault, (3.0, 1.5), thickness=0.006)
