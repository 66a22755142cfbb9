"""Upright surfaces are drawn in elevation, others in plan."""

from dataclasses import replace

import ezdxf
import numpy as np
import pytest
import shapely

import compas_cgc
from compas_cgc.fabrication import curve_net
from compas_cgc.fabrication import draw_plan
from compas_cgc.fabrication import moulds
from compas_cgc.fabrication import panels
from compas_cgc.fabrication import plane_quads
from compas_cgc.fabrication import unroll
from compas_cgc.fabrication.drawing import overlap
from compas_cgc.fabrication.drawing import text_box
from compas_cgc.fabrication.front_view import PLAN
from compas_cgc.fabrication.front_view import front_view
from compas_cgc.fabrication.front_view import view_name
from compas_cgc.fabrication.lath_files import draw_laths
from compas_cgc.fabrication.laths import lath_schedule
from compas_cgc.fabrication.panel_schedule import panel_sheets
from compas_cgc.io.nets import write_net
from compas_cgc.io.quads import write_quads

TURN = np.radians(30.0)
FRONT = np.array([np.sin(TURN), -np.cos(TURN), 0.0])  # horizontal, to which the outside of the upright surfaces points
UPRIGHT = np.array([[np.cos(TURN), np.sin(TURN), 0.0], [0.0, 0.0, 1.0], FRONT])


def pair(K):
    """Return a surface in plan, and the same one upright with its y upwards."""
    mesh = compas_cgc.CGCMesh.from_meshgrid(dx=8.0, dy=5.0, nx=16, ny=10)
    mesh.set_supports("corners")
    mesh.set_target(K)
    flat = compas_cgc.solve(mesh).problem
    return flat, replace(flat, vertices=flat.vertices @ UPRIGHT)


@pytest.fixture(scope="module")
def dome():
    return pair(0.01)


@pytest.fixture(scope="module")
def saddle():
    return pair(-0.01)


def test_the_view_of_an_upright_surface_is_its_elevation_from_outside(dome):
    flat, upright = dome
    assert front_view(flat) is PLAN
    assert front_view(upright) == pytest.approx(UPRIGHT, abs=0.02)


def test_pieces_and_panels_of_an_upright_surface_are_drawn_as_those_in_plan(dome):
    sizes, titles = [], []
    for problem in dome:
        drawn = draw_plan(unroll(problem, (3.0, 1.5), strain=0.01, rough=True))
        titles.append({text.text.split(" ")[0] for text in drawn.texts if text.layer == "SHEET"})
        boxes = [np.ptp(line.points, axis=0) for line in drawn.lines if line.layer == "OUTLINE"]
        assert min(float(box.min()) for box in boxes) > 0.3
        sheets = panel_sheets(problem, moulds(problem, panels(problem, 2.0), rough=True))
        outline = np.concatenate([own.corners for own in sheets]) @ sheets[0].view[:2].T
        sizes.append(np.ptp(outline, axis=0))
    assert titles == [{"plan"}, {"elevation"}]
    assert sizes[1] == pytest.approx(sizes[0], rel=0.02)


@pytest.mark.nightly
def test_steep_pieces_and_panels_are_drawn_in_elevations():
    mesh = compas_cgc.CGCMesh.from_meshgrid(dx=12.0, nx=24)
    mesh.set_supports("boundary")
    mesh.set_target(0.018)
    problem = compas_cgc.solve(mesh, settings={"measure": "exact"}).problem
    cut = unroll(problem, (3.0, 1.5), rough=True)
    drawn = draw_plan(cut)
    titles = [text.text for text in drawn.texts if text.layer == "SHEET"]
    sides = [f"{side} elevation" for side in ("south", "east", "north", "west")]
    assert [title.split(" of ")[0] for title in titles] == ["plan", *sides[::-1]]
    names = [text for text in drawn.texts if text.layer == "LABEL"]
    assert sorted(text.text.split()[0] for text in names) == sorted(piece.label for piece in cut.pieces)
    assert sum(int(title.split(" of ")[1].split()[0]) for title in titles) == len(cut.pieces)
    boxes = [text_box(text.text, text.place, text.height) for text in names]
    assert not any(overlap(one, other) for k, one in enumerate(boxes) for other in boxes[:k])
    sheets = panel_sheets(problem, moulds(problem, panels(problem, 2.0), rough=True))
    assert {view_name(own.view, (0.0, 1.0)) for own in sheets} == {"plan", *sides}
    for own in sheets:
        corners = own.corners - own.corners.mean(axis=0)
        normal = np.linalg.svd(corners)[2][2]
        assert abs(own.view[2] @ normal) > 0.45


def test_numbers_of_quads_of_an_upright_surface_are_read_from_outside(dome, tmp_path):
    quads = plane_quads(dome[1], 1.2)
    write_quads(tmp_path / "q.dxf", quads)
    document = ezdxf.readfile(tmp_path / "q.dxf")
    axes = front_view(dome[1])
    texts = {text.dxf.text: text for text in document.modelspace().query("TEXT")}
    for number, face in enumerate(quads.faces):
        text = texts[f"F{number}"]
        assert np.array(text.dxf.extrusion) == pytest.approx(axes[2])
        # The text runs to the right of the viewer, and lies in its face.
        assert np.array(text.ocs().to_wcs((1.0, 0.0, 0.0))) == pytest.approx(axes[0])
        place = np.array(text.ocs().to_wcs(text.get_placement()[1]))
        assert shapely.Polygon(1e3 * quads.vertices[face] @ axes[:2].T).contains(shapely.Point(axes[:2] @ place))
    legend = [axes[:2] @ np.array(own.ocs().to_wcs(own.get_placement()[1])) for own in document.modelspace().query('TEXT[layer=="LEGEND"]')]
    assert max(place[1] for place in legend) < 1e3 * (quads.vertices @ axes[1]).min()
    assert np.array(document.viewports.get("*Active")[0].dxf.direction) == pytest.approx(axes[2])
    assert not document.audit().errors


def test_nets_and_laths_of_an_upright_surface_are_drawn_in_elevation(saddle, tmp_path):
    net = curve_net(saddle[1], 1.0, rough=True)
    write_net(tmp_path / "net.dxf", net)
    texts = ezdxf.readfile(tmp_path / "net.dxf").modelspace().query('TEXT[layer=="CURVE_NUMBERS"]')
    assert len(texts) == len(net.curves)
    assert all(np.array(text.dxf.extrusion) == pytest.approx(front_view(saddle[1])[2]) for text in texts)
    plans = []
    for problem in saddle:
        drawn = draw_laths(lath_schedule(curve_net(problem, 1.0, rough=True)))
        plans.append(np.ptp(np.concatenate([line.points for line in drawn.lines if line.layer == "OUTLINE"]), axis=0))
    assert plans[1] == pytest.approx(plans[0], rel=0.03)
