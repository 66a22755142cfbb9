"""Surfaces in the file of the definition: shown when it is opened again, also while run is false."""

from __future__ import annotations

import sys
import types

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc.grasshopper.components import solve as solve_module
from compas_cgc.grasshopper.runtime import saved
from compas_cgc.grasshopper.runtime.address import Address
from compas_cgc.grasshopper.runtime.fingerprint import fingerprint
from compas_cgc.grasshopper.runtime.fingerprint import problem_fingerprint
from compas_cgc.solvers import solve

from ...support.gh_stand_ins import Document
from ...support.gh_stand_ins import place
from ...support.gh_stand_ins import rhino  # noqa: F401
from .test_solve import dome
from .test_solve import until_done

pytestmark = pytest.mark.usefixtures("rhino")


def reopened(placed):
    """Return the component of the same definition, opened from its file in another session."""
    document = Document()
    document.ValueTable.texts = dict(placed.component.document.ValueTable.texts)
    again = place("Solve", document)
    again.component.InstanceGuid = placed.component.InstanceGuid
    return again


@pytest.fixture
def solved():
    placed = place("Solve")
    return placed, until_done(placed, cgc_mesh=dome(), run=True)[-1]


def no_solve(*args):
    raise AssertionError("nothing is to be solved")


def test_a_surface_is_shown_with_its_colours_when_the_definition_is_opened_again(solved, monkeypatch):
    placed, before = solved
    monkeypatch.setattr(solve_module, "local_solve", no_solve)
    for run in (False, True):
        again = reopened(placed)
        assert again.run(cgc_mesh=dome(), run=run)["mesh"] is not None, "at once, before it is measured"
        out = again.settle(cgc_mesh=dome(), run=run)
        assert (out["status"], out["report"], out["legend"]) == (before["status"], before["report"], before["legend"])
        assert np.array_equal(out["mesh"].Vertices, before["mesh"].Vertices) and out["mesh"].VertexColors == before["mesh"].VertexColors
        assert problem_fingerprint(out["cgc_mesh"]) == problem_fingerprint(before["cgc_mesh"]) and not again.component.balloons


def test_a_surface_of_other_inputs_is_out_of_date_until_it_is_solved(solved):
    placed, before = solved
    again = reopened(placed)
    out = again.run(cgc_mesh=dome(0.012), run=False)
    assert out["status"] == "out of date" and np.array_equal(out["mesh"].Vertices, before["mesh"].Vertices)
    out = until_done(again, cgc_mesh=dome(0.012), run=True)[-1]
    assert out["status"] == "converged" and out["cgc_mesh"].region_target(0) == 0.012
    later = reopened(again).run(cgc_mesh=dome(0.012), run=False)
    assert np.array_equal(later["mesh"].Vertices, out["mesh"].Vertices), "the file has the newer one"


def test_a_surface_of_another_version_is_out_of_date(solved, monkeypatch):
    monkeypatch.setattr(saved, "__version__", "0.0.1")
    assert reopened(solved[0]).run(cgc_mesh=dome(), run=False)["status"] == "out of date"


def test_reset_deletes_it_from_the_file(solved):
    placed, _ = solved
    placed.run(cgc_mesh=dome(), reset=True)
    out = reopened(placed).run(cgc_mesh=dome(), run=False)
    assert out["mesh"] is None and out["status"] == "waiting"


def test_components_that_are_deleted_leave_nothing_in_the_file(solved):
    placed, _ = solved
    table, other = placed.component.document.ValueTable, place("Solve", placed.component.document)
    placed.component.document = None
    until_done(other, cgc_mesh=dome(0.02), run=True)
    assert not any(str(placed.component.InstanceGuid) in text for item in table.texts.items() for text in item)
    assert sum(str(other.component.InstanceGuid) in key for key in table.texts) == 1


def test_branches_have_their_own_surfaces():
    placed, meshes = place("Solve"), [dome(0.01), dome(0.02)]
    for placed.component.RunCount, mesh in enumerate(meshes, 1):
        placed.run(cgc_mesh=mesh, run=True, wait=True)
    again = reopened(placed)
    heights = []
    for again.component.RunCount, mesh in enumerate(meshes, 1):
        heights.append(max(point.Z for point in again.run(cgc_mesh=mesh, run=False)["mesh"].Vertices))
    assert heights[0] < 0.8 * heights[1]


def test_headless_documents_are_not_saved(monkeypatch):
    monkeypatch.setattr(sys.modules["Rhino"], "RhinoApp", types.SimpleNamespace(IsRunningHeadless=True), raising=False)
    placed = place("Solve")
    assert placed.run(cgc_mesh=dome(), run=True)["status"] == "converged" and not placed.component.document.ValueTable.texts


def test_the_key_of_a_server_is_not_saved():
    component = place("Solve").component
    inputs = (fingerprint(Address("http://studio-pc:7331", "very secret")),)
    saved.save(component, inputs, "text")
    assert saved.load(component).is_for(inputs) and "secret" not in repr(component.document.ValueTable.texts)


def test_problems_come_back_without_loss():
    mesh = CGCMesh.from_meshgrid(dx=9.0, nx=6)
    mesh.set_supports("corners")
    mesh.set_creases([[7 * i + 3 for i in range(7)]])
    mesh.set_target(0.01, region=0)
    mesh.set_law("H = 0.05", region=1)
    mesh.attributes["units"] = "Meters"
    other = CGCMesh.from_meshgrid(dx=9.0, nx=6)
    other.set_supports("corners")
    other.set_target(0.01)
    for problem in (mesh.to_problem(), other.to_problem().with_goals([{"kind": "rise", "rise": 1.0}]), solve(other).problem):
        back = saved.problem_from_text(saved.problem_to_text(problem))
        assert problem_fingerprint(back) == problem_fingerprint(problem) and back.drawing == problem.drawing
        assert np.array_equal(back.names.vertices, problem.names.vertices)
        assert (back.origin is None) == (problem.origin is None) and (
            problem.origin is None or back.origin.measure == problem.origin.measure
        )
