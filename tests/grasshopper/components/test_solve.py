"""The life of a solve on the canvas: run, progress, newer input, cancel, reset, removal."""

from __future__ import annotations

import time

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import FlowSettings
from compas_cgc.discrete import gaussian_curvature
from compas_cgc.grasshopper.components import solve as component_module
from compas_cgc.grasshopper.runtime.background import Progress
from compas_cgc.grasshopper.runtime.background import Work
from compas_cgc.grasshopper.runtime.local_solve import Question
from compas_cgc.solvers.projection import AtHeight

from ...support.gh_stand_ins import place
from ...support.gh_stand_ins import rhino  # noqa: F401
from ...support.server_process import PATIENCE
from ...support.server_process import wait_for

pytestmark = pytest.mark.usefixtures("rhino")


def dome(K=0.01, n=9):
    mesh = CGCMesh.from_meshgrid(dx=9.0, nx=n)
    mesh.set_supports("boundary")
    mesh.set_target(K)
    return mesh


def endless():
    """Return a question that takes longer than any test: no step satisfies a tolerance of zero."""
    return dict(cgc_mesh=dome(n=30), settings=FlowSettings(steps=10**6, tolerance=0.0))


def memory_of(placed):
    """Return what a component remembers."""
    return component_module._MEMORIES.get(f"{placed.component.InstanceGuid}/{placed.component.RunCount}")


def until_done(placed, **inputs):
    """Run a component whenever its canvas wants it to, and return all outputs, the last one last."""
    outs = [placed.run(**inputs)]
    end = time.monotonic() + 2 * PATIENCE
    while outs[-1]["status"] == "running":
        assert time.monotonic() < end, "the solve does not end"
        time.sleep(0.02)
        assert placed.component.document.tick() >= 1 and placed.component.expired
        outs.append(placed.run(**inputs))
    return outs


def test_from_toggle_to_surface():
    placed = place("Solve")
    mesh = dome()
    out = placed.run(cgc_mesh=mesh, run=False)
    assert out["status"] == "waiting" and placed.component.Message == "set run to true" and not placed.component.document.scheduled
    outs = until_done(placed, cgc_mesh=mesh, run=True)
    assert outs[0]["mesh"] is None and [out["status"] for out in outs[:-1]] == ["running"] * (len(outs) - 1)
    out = outs[-1]
    assert out["status"] == "converged" and out["progress"] == 1.0 and not placed.component.balloons
    assert placed.component.Message == "converged" and "max error" in out["report"] and out["result"].status == "converged"
    vertices = np.array(out["mesh"].Vertices)
    inner = [v for v in mesh.vertices() if mesh.vertex_role(v) == "internal"]
    faces = [(f.A, f.B, f.C) for f in out["mesh"].Faces]
    assert gaussian_curvature(vertices, faces)[inner] == pytest.approx(0.01, rel=1e-5)
    assert out["cgc_mesh"].region_target(0) == 0.01 and mesh.arrays()[0][:, 2].max() == 0, "the input is not changed"
    history = place("History").run(result=out["result"])
    assert len(history["step"]) == len(history["max_error"]) == len(out["result"].history["energy"])
    analysed = place("Analyse").run(cgc_mesh=out["cgc_mesh"], show="error")
    assert max(abs(x) for x in analysed["error"] if x is not None) < 1e-7


def test_nothing_new_costs_next_to_nothing():
    placed = place("Solve")
    mesh = dome()
    inputs = dict(cgc_mesh=mesh, settings=FlowSettings(steps=5), run=True)
    done = until_done(placed, **inputs)[-1]
    assert done["status"] == "step_limit" and "not converged in 5 steps" in placed.said("Warning")[0]
    asked = []
    real = Question.fingerprint
    try:
        Question.fingerprint = lambda self: asked.append(self) or real(self)
        again = placed.run(**inputs)
        assert again["mesh"] is done["mesh"] and not asked, "neither solved nor compared nor converted again"
        same = placed.run(**{**inputs, "cgc_mesh": mesh.copy(), "settings": FlowSettings(steps=5)})
        assert same["mesh"] is done["mesh"] and len(asked) == 1, "an equal mesh is no news"
    finally:
        Question.fingerprint = real
    assert not placed.component.document.scheduled


def test_progress_is_shown_and_rises():
    placed = place("Solve")
    outs = until_done(placed, cgc_mesh=dome(n=30), settings=FlowSettings(tolerance=1e-9), run=True)
    parts = [out["progress"] for out in outs]
    assert parts[0] < 0.5 and parts[-1] == 1.0 and all(0 <= part <= 1 for part in parts)


def test_a_newer_input_cancels_the_older_one():
    placed = place("Solve")
    placed.run(run=True, **endless())
    first = memory_of(placed).work
    assert first.running
    outs = until_done(placed, cgc_mesh=dome(), run=True)
    assert outs[-1]["status"] == "converged" and first.wait(PATIENCE), "the older solve has ended"
    assert outs[-1]["cgc_mesh"].number_of_vertices() == 100


def test_the_last_result_stays_until_the_next_one_is_there():
    placed = place("Solve")
    done = until_done(placed, cgc_mesh=dome(), run=True)[-1]
    out = placed.run(cgc_mesh=dome(0.02), run=False)
    assert out["mesh"] is done["mesh"] and out["status"] == "out of date" and placed.component.Message == "set run to true"
    outs = until_done(placed, cgc_mesh=dome(0.02), run=True)
    assert outs[0]["mesh"] is done["mesh"] and outs[0]["status"] == "running"
    assert outs[-1]["status"] == "converged" and outs[-1]["mesh"] is not done["mesh"]
    assert placed.run(run=True)["mesh"] is outs[-1]["mesh"] and placed.said("Warning") == ["connect a CGC mesh"]


def test_a_button_is_enough_to_start():
    placed = place("Solve")
    mesh = dome()
    assert placed.run(cgc_mesh=mesh, run=True)["status"] == "running"
    assert until_done(placed, cgc_mesh=mesh, run=False)[-1]["status"] == "converged"


def test_reset_cancels_and_forgets():
    placed = place("Solve")
    inputs = endless()
    placed.run(run=True, **inputs)
    work = memory_of(placed).work
    out = placed.run(run=True, reset=True, **inputs)
    assert work.wait(PATIENCE) and set(out.values()) == {None} and placed.component.Message == "reset"
    assert memory_of(placed) is None


def test_removing_the_component_cancels():
    placed = place("Solve")
    placed.run(run=True, **endless())
    work = memory_of(placed).work
    document, placed.component.document = placed.component.document, None
    placed.component.expired = False
    document.tick()
    assert work.wait(PATIENCE) and not placed.component.expired and not document.scheduled
    assert memory_of(placed) is None


def test_two_components_do_not_disturb_each_other():
    first, second = place("Solve"), place("Solve")
    first.run(run=True, **endless())
    assert until_done(second, cgc_mesh=dome(), run=True)[-1]["status"] == "converged"
    assert first.run(run=True, **endless())["status"] == "running"
    first.run(reset=True)


def test_constraints_are_held():
    mesh = dome()
    crown = next(v for v in mesh.vertices() if mesh.vertex_coordinates(v)[:2] == [4.0, 4.0])
    placed = place("Solve")
    out = until_done(placed, cgc_mesh=mesh, constraints=[AtHeight([crown], 1.0)], run=True)[-1]
    assert out["status"] == "converged" and out["mesh"].Vertices[crown].Z == pytest.approx(1.0, abs=1e-9)
    again = until_done(placed, cgc_mesh=mesh, constraints=[AtHeight([crown], 1.1)], run=True)[-1]
    assert again["mesh"].Vertices[crown].Z == pytest.approx(1.1, abs=1e-9), "a changed constraint is a newer input"


def test_several_meshes_on_one_wire_are_several_solves():
    placed = place("Solve")
    meshes = [dome(), dome(0.02)]

    def solution():
        outs = []
        for placed.component.RunCount, mesh in enumerate(meshes, 1):
            outs.append(placed.run(cgc_mesh=mesh, run=True))
        return outs

    outs = solution()
    end = time.monotonic() + PATIENCE
    while any(out["status"] == "running" for out in outs):
        assert time.monotonic() < end
        time.sleep(0.02)
        placed.component.document.tick()
        outs = solution()
    assert [out["status"] for out in outs] == ["converged"] * 2
    heights = [max(p.Z for p in out["mesh"].Vertices) for out in outs]
    assert heights[0] < heights[1]


def test_refusals_are_red_and_stay_red():
    placed = place("Solve")
    mesh = dome(K=0.5)
    assert until_done(placed, cgc_mesh=mesh, run=True)[-1]["status"] == "refused"
    for _ in range(2):
        assert placed.run(cgc_mesh=mesh, run=True)["mesh"] is None
        assert "is more than this boundary can carry" in placed.said("Error")[0] and placed.component.Message == "refused"
    wrong = [AtHeight([0], 1.0)]
    assert until_done(placed, cgc_mesh=dome(), settings=FlowSettings(), constraints=wrong, run=True)[-1]["status"] == "refused"
    assert "holds constraints" in placed.said("Error")[0]
    assert until_done(placed, cgc_mesh=dome(), run=True)[-1]["status"] == "converged" and not placed.component.balloons


def test_a_fault_of_the_program_is_not_hidden():
    placed = place("Solve")

    def broken(tell):
        raise ZeroDivisionError("a fault")

    original, component_module._job = component_module._job, lambda question: broken
    try:
        placed.run(cgc_mesh=dome(), run=True)
        assert memory_of(placed).work.wait(PATIENCE)
        with pytest.raises(ZeroDivisionError):
            placed.run(cgc_mesh=dome(), run=True)
    finally:
        component_module._job = original


def test_work_tells_and_stops():
    def count(tell):
        step = 0
        while not tell(Progress(step)):
            step += 1
            time.sleep(0.001)
        return step

    work = Work(count)
    wait_for(lambda: work.progress is not None and work.progress.step > 0)
    assert not work.wait(0.05)
    work.cancel()
    assert work.wait(PATIENCE) and work.outcome >= work.progress.step and work.refusal is None
