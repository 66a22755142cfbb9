"""Rationalise: from a mesh on the canvas to panels on few moulds, in the background."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.grasshopper.components import rationalise as module
from compas_cgc.rationalisation import rationalise

from ...support.gh_stand_ins import Document
from ...support.gh_stand_ins import Point3d
from ...support.gh_stand_ins import place
from ...support.gh_stand_ins import rhino  # noqa: F401
from ...support.gh_stand_ins import rhino_mesh

pytestmark = pytest.mark.usefixtures("rhino")


def design():
    x, y = np.meshgrid(np.linspace(-6, 6, 25), np.linspace(-4, 4, 17), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), (2 - 0.03 * x**2 - 0.05 * y**2).ravel()])
    return vertices, [[i * 17 + j, i * 17 + 17 + j, i * 17 + 18 + j, i * 17 + 1 + j] for i in range(24) for j in range(16)]


def test_a_mesh_becomes_panels_on_two_moulds(monkeypatch):
    placed, own = place("Rationalise"), rhino_mesh(*design())
    assert placed.run(design=own, panel=4.0, moulds=[2.0])["mesh"] is None and placed.component.Message == "set run to true"
    out = placed.settle(design=own, panel=4.0, moulds=[2.0], run=True)
    expected = rationalise(design(), panel=4.0, moulds=2)
    assert not placed.said("Error") and placed.component.Message == "6 panels, 2 moulds"
    assert np.array_equal(np.array(out["mesh"].Vertices), expected.result.vertices), "as in Python"
    assert out["classes"] == expected.classes.tolist() and out["curvatures"] == expected.curvatures.tolist()
    assert len(out["panels"]) == 6 and sum(len(panel.Faces) for panel in out["panels"]) == len(out["mesh"].Faces)
    assert max(map(abs, out["distance"])) == pytest.approx(expected.distance.largest) and out["kinks"] == expected.folds.angles.tolist()
    assert len(out["seam_lines"]) == len(expected.panelling.seams) and out["report"] == expected.summary
    moulds = place("Mould").settle(cgc_mesh=out["cgc_mesh"])
    assert len(moulds["panels"]) == 6 and len(moulds["moulds"]) == 2
    monkeypatch.setattr(module, "rationalise_design", None)
    document = Document()
    document.ValueTable.texts = dict(placed.component.document.ValueTable.texts)
    again, changed = (place("Rationalise", document) for _ in range(2))
    again.component.InstanceGuid = changed.component.InstanceGuid = placed.component.InstanceGuid
    assert changed.run(design=own, panel=4.0, moulds=[3.0], run=False)["report"] == out["report"]
    assert changed.component.Message == "set run to true", "it is out of date"
    back = again.settle(design=own, panel=4.0, moulds=[2.0], run=False)
    assert not again.said("Error") and again.component.Message == placed.component.Message, "nothing is computed"
    same = [name for name in out if name not in ("mesh", "cgc_mesh", "panels", "seam_lines")]
    assert [back[name] for name in same] == [out[name] for name in same], "when the definition is opened again"
    assert np.array_equal(back["mesh"].Vertices, out["mesh"].Vertices) and back["mesh"].VertexColors == out["mesh"].VertexColors
    assert [panel.Faces for panel in back["panels"]] == [panel.Faces for panel in out["panels"]]


def test_costs_decide_between_surfaces_within_a_limit():
    placed = place("Rationalise")
    given = {"design": rhino_mesh(*design()), "panel": 4.0, "limit": 0.5, "run": True, "weights": [0.0, 0.0, 2.0, 1.0, 2.0]}
    out = placed.settle(**given, costs=[0.0, 100.0, 5000.0, 400.0, 9000.0, 700.0])
    assert not placed.said("Error") and out["curvatures"] == [0.0] and "costs: 600" in out["report"]


@pytest.mark.parametrize(
    "inputs, sentence",
    [
        ({"moulds": [2.5]}, "moulds must be a whole number, or the radii of two or more moulds, not 2.5"),
        ({"costs": [1.0, 2.0]}, "costs are six numbers"),
        ({"weights": [1.0, 2.0, 0.0, 1.0, -1.0]}, "weights must be rows"),
        ({"panel": -1.0}, "panel must be a length above zero"),
        ({"design": Point3d(0.0, 0.0, 0.0)}, "the input design received a Point3d; connect a mesh"),
        ({"design": "nowhere.3dm"}, "nowhere.3dm"),
    ],
)
def test_wrong_inputs_are_named(inputs, sentence):
    placed = place("Rationalise")
    out = placed.settle(**{"design": rhino_mesh(*design()), "run": True, **inputs})
    assert out["mesh"] is None and sentence in placed.said("Error")[0]
