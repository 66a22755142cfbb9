"""The slider of the page goes on from the last surface, and comes to that of a solve from the drawing."""

from __future__ import annotations

import json

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import solve

from ...support.hands import BUSY
from ...support.hands import open_hands
from ...support.server_process import running_server
from ...support.server_process import wait_for

pytestmark = pytest.mark.nightly
WATCH = """
const { Solving } = await import('/page/solving.js');
const told = window.told = { last: [], tolerances: [], solving: null };
const done = Solving.prototype.done;
Solving.prototype.done = function (...given) { told.solving = this; return done.apply(this, given); };
const fetched = window.fetch;
window.fetch = function (address, options) {
  if (String(address).includes('follow=true')) {
    const asked = JSON.parse(options.body);
    told.last.push(Boolean(asked.last));
    told.tolerances.push(asked.settings.tolerance ?? null);
  }
  return fetched.apply(this, [address, options]);
};
return true
"""
HOLD = """
const slider = document.querySelector('.region [type=range]');
slider.value = Number(slider.value) + 2;
slider.dispatchEvent(new Event('input', { bubbles: true }));
"""
LET_GO = "document.querySelector('.region [type=range]').dispatchEvent(new Event('change', { bubbles: true }))"
TOLERANCES = "return JSON.stringify(window.told.tolerances)"
FOUND = "const { result } = window.told.solving; return JSON.stringify([[...result.xyz], result.message, window.told.last])"


def test_the_surface_of_the_slider_is_that_of_a_solve_from_the_drawing(tmp_path):
    pytest.importorskip("selenium", reason="selenium is not installed")
    roof = CGCMesh.from_meshgrid(dx=6.0, nx=10)
    V, F = roof.to_vertices_and_faces()
    text = "".join(f"v {x} {y} {z}\n" for x, y, z in V) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in F)
    roof.set_supports("corners")
    with running_server(tmp_path / "jobs.sqlite", workers=1) as server, open_hands("chromium", tmp_path) as hands:

        def found():
            """Wait for the surface that was asked for; return its vertices, its message, and which solves went on from the last."""
            wait_for(lambda: hands.text(".verdict.good h2") == "Target reached" and not hands.shown(BUSY), what="the roof is not solved")
            return json.loads(hands.read(FOUND))

        hands.open(f"{server.url}/#new")
        hands.seen(".example")
        hands.read(WATCH)
        hands.read(
            "const list = new DataTransfer(); list.items.add(new File([args[0]], 'roof.obj'));"
            "const input = document.querySelector('#file'); input.files = list.files; input.dispatchEvent(new Event('change'));",
            text,
        )
        hands.seen("#solve")
        hands.click("#supports [value=corners] + span")
        hands.click("#solve")
        found()
        for K in (0.021, 0.018):
            hands.fill(".region .number", K)
            xyz, message, on = found()
            roof.set_target(K)
            assert on[-1] and "starting from the previous surface" in message
            assert np.abs(np.reshape(xyz, (-1, 3)) - solve(roof).vertices).max() < 1e-9 * 6.0
        hands.read(HOLD)
        held = np.reshape(found()[0], (-1, 3))
        assert json.loads(hands.read(TOLERANCES))[-2:] == [None, 1e-5]
        hands.read(LET_GO)
        wait_for(lambda: json.loads(hands.read(TOLERANCES))[-2:] == [1e-5, None], what="what was held is not found to the last digit")
        let_go = np.reshape(found()[0], (-1, 3))
        roof.set_target(float(hands.value(".region .number")))
        assert 0.0 < np.abs(let_go - held).max() < 1e-5 * 6.0
        assert np.abs(let_go - solve(roof).vertices).max() < 1e-9 * 6.0
        hands.read(LET_GO)
        assert len(json.loads(hands.read(TOLERANCES))) == len(found()[2])
        hands.click("#supports [value=boundary] + span")
        wait_for(lambda: not found()[2][-1], what="with other supports the drawing is another problem, but the last surface is sent")
