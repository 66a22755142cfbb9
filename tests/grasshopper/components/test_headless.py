"""Documents that nobody looks at, and `wait`: one solution gives the surface, or a red balloon with the cause."""

from __future__ import annotations

import sys
import types

import pytest

from compas_cgc import CGCMesh
from compas_cgc import FlowSettings

from ...support.gh_stand_ins import place
from ...support.gh_stand_ins import rhino  # noqa: F401
from .test_solve import gate  # noqa: F401

pytestmark = pytest.mark.usefixtures("rhino")


def dome(K=0.01):
    mesh = CGCMesh.from_meshgrid(dx=9.0, nx=9)
    mesh.set_supports("boundary")
    mesh.set_target(K)
    return mesh


def compute(monkeypatch, placed):
    """Let Rhino run without windows, as rhino.compute does."""
    monkeypatch.setattr(sys.modules["Rhino"], "RhinoApp", types.SimpleNamespace(IsRunningHeadless=True), raising=False)


def cluster(monkeypatch, placed):
    placed.component.document.Owner = object()


@pytest.mark.parametrize("headless", [compute, cluster])
def test_one_solution_gives_the_surface(monkeypatch, headless):
    placed = place("Solve")
    headless(monkeypatch, placed)
    out = placed.run(cgc_mesh=dome(), run=True)
    assert out["status"] == "converged" and max(point.Z for point in out["mesh"].Vertices) > 0.5 and out["report"]
    assert not placed.component.document.scheduled, "nothing would run it"


def test_wait_gives_every_input_its_surface(gate):  # noqa: F811
    placed = place("Solve")
    heights = []
    for K in (0.005, 0.01, 0.02):
        out = placed.run(cgc_mesh=dome(K), run=True, wait=True)
        assert out["status"] == "converged" and out["cgc_mesh"].region_target(0) == K
        heights.append(max(point.Z for point in out["mesh"].Vertices))
    assert heights == sorted(heights) and not placed.component.document.scheduled
    gate.clear()
    later = place("Solve").run(cgc_mesh=dome(), run=True)
    assert later["status"] == "running" and later["mesh"] is None, "without wait, the canvas goes on"


@pytest.mark.parametrize(
    ("inputs", "sentence"),
    [
        ({"run": False}, "run is False, so that there is no surface; set run to True"),
        ({"run": True, "cgc_mesh": dome(-0.5), "settings": FlowSettings(steps=3)}, ""),
        ({"run": True, "cgc_mesh": CGCMesh.from_meshgrid(dx=9.0, nx=9)}, "support"),
    ],
)
def test_without_a_surface_there_is_a_balloon_with_the_cause(monkeypatch, inputs, sentence):
    placed = place("Solve")
    compute(monkeypatch, placed)
    out = placed.run(**{"cgc_mesh": dome(), **inputs})
    said = placed.said("Error") + placed.said("Warning")
    assert said and any(sentence in own for own in said)
    assert out["mesh"] is not None or placed.said("Error")


def test_analyse_measures_at_once(monkeypatch):
    placed = place("Analyse")
    cluster(monkeypatch, placed)
    assert placed.run(cgc_mesh=dome())["report"] and not placed.component.document.scheduled
