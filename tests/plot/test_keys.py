"""Keys of pictures: scale, north and K."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("matplotlib")

import compas_cgc
from compas_cgc import CGCMesh
from compas_cgc import plot
from compas_cgc.fabrication.picture_key import Key
from compas_cgc.fabrication.picture_key import draw_key
from compas_cgc.fabrication.picture_key import key_of
from compas_cgc.fabrication.picture_key import round_below
from compas_cgc.plot.view import View
from compas_cgc.plot.view import project
from compas_cgc.plot.view import view_axes
from compas_cgc.rationalisation.design import given_design


@pytest.fixture(scope="module")
def plan():
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=4)
    mesh.attributes.update(units="Meters", north=[1.0, 1.0])
    return mesh.to_problem().with_targets(0.02)


@pytest.mark.parametrize("length, bar", [(1.0, 1.0), (0.99, 0.5), (4.99, 2.0), (5000.0, 5000.0), (0.0234, 0.02)])
def test_a_scale_bar_is_1_2_or_5(length, bar):
    assert round_below(length) == pytest.approx(bar)


def test_a_key_tells_unit_north_and_K(plan):
    assert key_of(plan) == Key("m", (1.0, 1.0), ("K = 0.02 1/m²",))
    bare = replace(plan, drawing=plan.drawing._replace(units=None))
    assert key_of(bare).unit == ""


@pytest.mark.parametrize("view", [View(-90.0, 90.0), View(-60.0, 30.0), View(20.0, 5.0)])
def test_the_arrow_points_where_north_is_in_the_view(view):
    towards = np.array([0.6, 0.8, 0.0])
    ends = project(np.stack([np.zeros(3), towards]), view, np.zeros((1, 3)))[:, :2]
    shaft = draw_key(Key("m", (3.0, 4.0)), 100.0, 1.0, 2.0, view_axes(view)).lines[1]
    along, seen = shaft[-1] - shaft[0], ends[1] - ends[0]
    assert along / np.linalg.norm(along) == pytest.approx(seen / np.linalg.norm(seen))


def test_an_arrow_to_the_left_keeps_clear_of_the_scale_bar():
    """North lies to the left of a viewer in the west."""
    marks = draw_key(Key("mm"), 10_000.0, 1.0, 100.0, np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]]))
    (length, start), (north, letter) = marks.texts[:2]
    assert north == "N" and letter[0] > start[0] + 0.8 * 100.0 * len(length)


@pytest.mark.parametrize("azimuth, words", [(-90.0, "N: away from the viewer"), (90.0, "N: towards the viewer")])
def test_north_along_the_line_of_sight_is_a_word(azimuth, words):
    assert words in [text for text, _ in draw_key(Key("m"), 100.0, 1.0, 2.0, view_axes(View(azimuth, 0.0))).texts]


def drawn_lines(ax):
    """Return the lines of the key below axes in points of the paper."""
    ax.figure.draw_without_rendering()
    return [72.0 / ax.figure.dpi * line.get_transform().transform(line.get_xydata()) for line in ax.lines]


@pytest.mark.parametrize("draw", ["shape", "zebra", "studio"])
def test_scale_bars_have_the_scale_of_their_pictures(plan, draw):
    shape, key = (plan.vertices, plan.faces, plan.roles), key_of(plan)
    flat = View(-90.0, 90.0)
    if draw == "studio":
        ax = plot.studio(*shape, view=flat, width=300, key=key).axes[0]
        scale = 72.0 / 200 * 300 / (1.1 * 6.0)
    else:
        ax = getattr(plot, f"draw_{draw}")(*shape, view=flat, key=key)
        ax.figure.draw_without_rendering()
        scale = 72.0 / ax.figure.dpi * ax.get_window_extent().width / np.ptp(ax.get_xlim())
    bar = drawn_lines(ax)[0]
    assert np.ptp(bar[:, 0]) == pytest.approx(1.0 * scale, rel=1e-6)
    assert {"1 m", "N", "K = 0.02 1/m²"} <= {text.get_text() for text in ax.texts}


def test_files_keep_their_north(plan, tmp_path):
    for name in ("plan.3dm", "plan.json"):
        compas_cgc.write(tmp_path / name, plan)
        north = compas_cgc.read(tmp_path / name).to_problem().drawing.north
        assert np.cross([*north, 0.0], [1.0, 1.0, 0.0]) == pytest.approx(0.0) and min(north) > 0.0
    assert given_design(tmp_path / "plan.3dm").drawing.north == pytest.approx((0.5**0.5, 0.5**0.5))
    turned = plan.transformed([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    assert turned.drawing.north == pytest.approx((-1.0, 1.0))
    mesh = CGCMesh.from_problem(plan)
    mesh.attributes["north"] = [0.0, 0.0]
    with pytest.raises(ValueError, match="the direction of north must be two numbers"):
        mesh.to_problem()
