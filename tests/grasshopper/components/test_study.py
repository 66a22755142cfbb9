"""The component Study, run as Grasshopper runs it."""

from __future__ import annotations

import pytest

from compas_cgc import CGCMesh
from compas_cgc.study import Study
from compas_cgc.study import run_study

from ...support.gh_stand_ins import place
from ...support.gh_stand_ins import rhino  # noqa: F401

pytestmark = pytest.mark.usefixtures("rhino")


def test_a_slider_runs_through_the_variants_of_a_study_that_is_not_finished_yet(tmp_path):
    mesh = CGCMesh.from_meshgrid(dx=6.0, nx=6)
    mesh.set_supports("boundary")
    study = Study.from_dict({"parameters": {"K": [0.004, 0.9, 0.008, 0.012]}, "pareto": {"least": "area", "most": "rise"}})
    results = run_study(mesh, study, tmp_path / "dome", on_progress=lambda state: state.done == 3)
    placed = place("Study")
    out = placed.run(path=str(tmp_path / "dome"), number=2, column="rise")
    assert out["values"] == results.column("rise") and out["front"] == [0, 2] and "K: 0.008" in out["row"]
    assert out["cgc_mesh"].region_target(0) == 0.008 and len(out["cgc_mesh"].supports()) == 24
    assert any("3 of 4 variants" in text for text in placed.said("Remark"))
    out = placed.run(path=str(tmp_path / "dome"), number=1)
    assert out["mesh"] is None and "status: refused" in out["row"]
    placed.run(path=str(tmp_path / "dome"), number=9)
    assert placed.said("Error")
