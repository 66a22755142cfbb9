"""The life of a solve on the canvas: run, progress, newer input, cancel, reset, removal."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import FlowSettings
from compas_cgc import Height
from compas_cgc import SolveResult
from compas_cgc.grasshopper.components import solve as component_module
from compas_cgc.grasshopper.runtime import runner
from compas_cgc.grasshopper.runtime.address import Address
from compas_cgc.grasshopper.runtime.background import BackgroundTask
from compas_cgc.grasshopper.runtime.component_feedback import as_list
from compas_cgc.grasshopper.runtime.fingerprint import fingerprint
from compas_cgc.grasshopper.runtime.progress import Progress
from compas_cgc.model.measures import measured_curvature
from compas_cgc.model.problem import CGCProblem

from ...support.gh_stand_ins import place
from ...support.gh_stand_ins import rhino  # noqa: F401
from ...support.rhino_models import Sketch
from ...support.server_process import PATIENCE

pytestmark = pytest.mark.usefixtures("rhino")


def dome(K=0.01, n=9):
    mesh = CGCMesh.from_meshgrid(dx=9.0, nx=n)
    mesh.set_supports("boundary")
    mesh.set_target(K)
    return mesh


def endless():
    """Return inputs of a solve that takes longer than any test: no step satisfies a tolerance of zero."""
    return dict(cgc_mesh=dome(n=30), settings=FlowSettings(steps=10**6, tolerance=0.0))


@pytest.fixture
def gate(monkeypatch):
    """An event; while it is cleared, no computation of a component begins."""
    opened, computed = threading.Event(), runner._computed
    opened.set()
    monkeypatch.setattr(runner, "_computed", lambda *inputs: opened.wait(PATIENCE) and computed(*inputs))
    yield opened
    opened.set()


def task_of(placed):
    """Return the running task of a component, or None."""
    return next(iter(component_module._RUNNER.tasks(placed.component)), None)


def until_done(placed, gate=None, **inputs):
    """Run a component whenever its canvas wants it to, and return all outputs, the last one last.

    With a gate, the first outputs are those before the computation.
    """
    if gate is not None:
        gate.clear()
    outs = [placed.run(**inputs)]
    if gate is not None:
        gate.set()
    end = time.monotonic() + PATIENCE
    while outs[-1]["status"] == "running":
        assert time.monotonic() < end, "the solve does not end"
        time.sleep(0.02)
        assert placed.component.document.tick() >= 1
        # It runs again, and what hangs on it, only when there is something new.
        if placed.component.expired:
            outs.append(placed.run(**inputs))
    return outs


def test_from_toggle_to_surface(gate):
    placed = place("Solve")
    mesh = dome()
    out = placed.run(cgc_mesh=mesh, run=False)
    assert out["status"] == "waiting" and out["mesh"] is None
    assert placed.component.Message == "set run to true" and not placed.component.document.scheduled
    outs = until_done(placed, gate, cgc_mesh=mesh, run=True)
    assert [out["status"] for out in outs[:-1]] == ["running"] * (len(outs) - 1)
    assert outs[0]["mesh"] is None and outs[0]["progress"] == 0.0
    out = outs[-1]
    assert out["status"] == "converged" and out["progress"] == 1.0 and not placed.component.balloons
    assert placed.component.Message == "converged" and "max error" in out["report"] and out["result"].status == "converged"
    vertices = np.array(out["mesh"].Vertices)
    inner = [v for v in mesh.vertices() if mesh.vertex_role(v) == "internal"]
    faces = [(f.A, f.B, f.C) for f in out["mesh"].Faces]
    solved = CGCProblem(vertices, faces).with_supports("boundary").with_targets(0.01)
    assert measured_curvature(solved)[inner] == pytest.approx(0.01, rel=1e-5)
    assert out["cgc_mesh"].region_target(0) == 0.01 and mesh.arrays()[0][:, 2].max() == 0, "the input is not changed"
    history = place("History").run(result=out["result"])
    assert len(history["step"]) == len(history["max_error"]) == len(out["result"].history.energy)
    analysed = place("Analyse").settle(cgc_mesh=out["cgc_mesh"], show="error")
    assert max(abs(x) for x in analysed["error"] if x is not None) < 1e-7


def test_nothing_new_costs_next_to_nothing(monkeypatch):
    placed = place("Solve")
    mesh = dome()
    inputs = dict(cgc_mesh=mesh, settings=FlowSettings(steps=5), run=True)
    done = until_done(placed, **inputs)[-1]
    assert done["status"] == "step_limit" and "not converged in 5 steps" in placed.said("Warning")[0]
    compared = []
    real = runner.fingerprint
    monkeypatch.setattr(runner, "fingerprint", lambda *inputs: compared.append(inputs) or real(*inputs))
    again = placed.run(**inputs)
    assert again["mesh"] is done["mesh"] and not compared, "neither solved nor compared nor converted again"
    same = placed.run(**{**inputs, "cgc_mesh": mesh.copy(), "settings": FlowSettings(steps=5)})
    assert same["mesh"] is done["mesh"] and len(compared) == 2, "an equal mesh with equal settings is no news"
    assert not placed.component.document.scheduled


def test_progress_is_shown_and_rises(gate):
    placed = place("Solve")
    outs = until_done(placed, gate, cgc_mesh=dome(n=30), settings=FlowSettings(tolerance=1e-9), run=True)
    parts = [out["progress"] for out in outs]
    assert parts[0] == 0.0 and parts[-1] == 1.0 and all(0 <= part <= 1 for part in parts)


def test_a_newer_input_cancels_the_older_one():
    placed = place("Solve")
    placed.run(run=True, **endless())
    first = task_of(placed)
    assert first.running
    outs = until_done(placed, cgc_mesh=dome(), run=True)
    assert outs[-1]["status"] == "converged" and first.wait(PATIENCE), "the older solve has ended"
    assert outs[-1]["cgc_mesh"].number_of_vertices() == 100


def test_the_last_result_stays_until_the_next_one_is_there(gate):
    placed = place("Solve")
    done = until_done(placed, cgc_mesh=dome(), run=True)[-1]
    out = placed.run(cgc_mesh=dome(0.02), run=False)
    assert out["mesh"] is done["mesh"] and out["status"] == "out of date" and placed.component.Message == "set run to true"
    outs = until_done(placed, gate, cgc_mesh=dome(0.02), run=True)
    assert outs[0]["mesh"] is done["mesh"] and outs[0]["status"] == "running"
    assert outs[-1]["status"] == "converged" and outs[-1]["mesh"] is not done["mesh"]
    assert placed.run(run=True)["mesh"] is outs[-1]["mesh"] and placed.said("Warning") == ["connect a CGC mesh"]


def test_run_set_to_false_stops():
    placed = place("Solve")
    assert placed.run(run=True, **endless())["status"] == "running"
    task = task_of(placed)
    inputs = endless()
    assert placed.run(run=False, **inputs)["status"] == "waiting"
    assert task.wait(PATIENCE) and task_of(placed) is None


def test_intermediate_surfaces_are_shown_and_nothing_is_solved_downstream():
    placed = place("Solve")
    inputs = endless()
    outs, texts = [placed.run(run=True, **inputs)], set()
    end = time.monotonic() + PATIENCE
    while (len(texts) < 3 or len(outs) < 4) and time.monotonic() < end:
        placed.component.document.tick()
        texts.add(placed.component.Message)
        if placed.component.expired:
            outs.append(placed.run(run=True, **inputs))
        time.sleep(0.02)
    assert len(texts) >= 3, "the text under the component goes on"
    assert len({id(out["mesh"]) for out in outs[1:]}) == len(outs) - 1 >= 3, "every surface is another one"
    assert all(out["cgc_mesh"] is None and out["status"] == "running" for out in outs), "Analyse and others wait for the result"
    assert placed.run(run=False, **inputs)["mesh"] is None, "what was not solved to the end is not kept"
    placed.run(reset=True)


def test_the_address_of_a_server_needs_no_http():
    assert component_module._address(" studio-pc:7331 ").url == "http://studio-pc:7331"
    assert component_module._address("https://studio-pc").url == "https://studio-pc"


def test_reset_cancels_and_forgets():
    placed = place("Solve")
    inputs = endless()
    placed.run(run=True, **inputs)
    task = task_of(placed)
    out = placed.run(run=True, reset=True, **inputs)
    assert task.wait(PATIENCE) and set(out.values()) == {None} and placed.component.Message == "reset"
    assert task_of(placed) is None


def test_removing_the_component_cancels():
    placed = place("Solve")
    placed.run(run=True, **endless())
    task = task_of(placed)
    document, placed.component.document = placed.component.document, None
    placed.component.expired = False
    document.tick()
    assert task.wait(PATIENCE) and not placed.component.expired and not document.scheduled
    assert task_of(placed) is None


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
    out = until_done(placed, cgc_mesh=mesh, goals=[Height([crown], 1.0)], run=True)[-1]
    assert out["status"] == "converged" and out["mesh"].Vertices[crown].Z == pytest.approx(1.0, abs=1e-9)
    again = until_done(placed, cgc_mesh=mesh, goals=[Height([crown], 1.1)], run=True)[-1]
    assert again["mesh"].Vertices[crown].Z == pytest.approx(1.1, abs=1e-9), "a changed constraint is a newer input"


def drawn_crown(height=0.5):
    """Return the model of a dome with a point drawn over its crown."""
    sketch, mesh = Sketch(), dome()
    vertices, faces = mesh.arrays()
    sketch.mesh(vertices, faces)
    sketch.points(vertices[mesh.supports()], "CGC::Supports")
    sketch.points([vertices[44] + [0.0, 0.0, height]], "CGC::Constraints")
    return sketch


def test_constraints_drawn_in_a_file_are_held(tmp_path):
    read = place("Read3dm").run(path=str(drawn_crown().save(tmp_path / "dome.3dm")))["cgc_mesh"]
    mesh = place("Target").run(cgc_mesh=read, K=[0.01])["cgc_mesh"]
    (drawn,) = mesh.goals()
    assert isinstance(drawn, Height) and drawn.height == 0.5
    placed = place("Solve")
    out = until_done(placed, cgc_mesh=mesh, run=True)[-1]
    assert out["status"] == "converged"
    assert out["mesh"].Vertices[drawn.vertices[0]].Z == pytest.approx(0.5, abs=1e-9), "not where K alone would lead it"
    second = [Height([22], 0.4)]
    both = until_done(placed, cgc_mesh=mesh, goals=second, run=True)[-1]["mesh"].Vertices
    assert [both[drawn.vertices[0]].Z, both[22].Z] == pytest.approx([0.5, 0.4], abs=1e-9), "those of the wire are added"
    again = place("Write3dm").run(path=str(tmp_path / "out.3dm"), cgc_mesh=out["cgc_mesh"], write=True)
    back = place("Read3dm").run(path=again["written"].AllData()[0])["cgc_mesh"]
    assert [one.height for one in back.goals()] == [0.5], "and the surface carries them on"


def test_a_change_on_any_wire_is_news():
    mesh = dome()
    held = mesh.copy()
    held.set_goals([Height([44], 0.5)])
    many = [Height(np.arange(2000), 1.0), Height(np.where(np.arange(2000) == 1000, 0, np.arange(2000)), 1.0)]
    inputs = [
        (mesh, None, None),
        (held, None, None),
        (mesh, FlowSettings(), None),
        (mesh, FlowSettings(steps=5), None),
        (mesh, None, Address("http://127.0.0.1:7331")),
        (mesh, None, Address("http://127.0.0.1:7332")),
        (mesh, None, None, Height([44], 0.5)),
        (mesh, None, None, Height([44], 0.6)),
        *((mesh, None, None, one) for one in many),
    ]
    assert len({fingerprint(*own) for own in inputs}) == len(inputs)
    assert fingerprint(*inputs[7]) == fingerprint(mesh.copy(), None, None, Height([44], 0.6))


def test_another_server_is_asked_anew():
    placed = place("Solve")
    mesh = dome()
    assert until_done(placed, cgc_mesh=mesh, run=True)[-1]["status"] == "converged"
    assert placed.run(cgc_mesh=mesh, run=False, server="http://127.0.0.1:1")["status"] == "out of date"
    assert placed.run(cgc_mesh=mesh, run=False)["status"] == "converged"


def test_what_is_on_the_wires_is_not_taken_apart():
    out = until_done(place("Solve"), cgc_mesh=dome(), settings=FlowSettings(steps=5), run=True)[-1]
    result = out["result"]
    assert isinstance(result, SolveResult) and result.problem is out["cgc_mesh"].problem and result.settings == FlowSettings(steps=5)
    for value in (result, result.settings, out["cgc_mesh"], Height([44], 0.5), Address("http://127.0.0.1:7331")):
        assert not isinstance(value, (tuple, dict)) and not hasattr(value, "__iter__") and as_list(value) == [value]


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
        assert "is too large for this boundary" in placed.said("Error")[0] and placed.component.Message == "refused"
    wrong = [Height([0], 1.0)]
    assert until_done(placed, cgc_mesh=dome(), settings=FlowSettings(), goals=wrong, run=True)[-1]["status"] == "refused"
    assert "supports constraints" in placed.said("Error")[0]
    assert until_done(placed, cgc_mesh=dome(), run=True)[-1]["status"] == "converged" and not placed.component.balloons


def test_a_fault_of_the_program_is_not_hidden(monkeypatch):
    placed = place("Solve")

    def broken(report):
        raise ZeroDivisionError("a fault")

    monkeypatch.setattr(component_module, "local_solve", lambda *inputs: broken)
    # The task may end before the first solution does.
    with pytest.raises(ZeroDivisionError):
        placed.run(cgc_mesh=dome(), run=True)
        assert task_of(placed).wait(PATIENCE)
        placed.run(cgc_mesh=dome(), run=True)


def test_a_task_reports_and_stops():
    begun = threading.Event()

    def count(report):
        step = 1
        while not report(Progress(step)):
            begun.set()
            step += 1
        return step

    task = BackgroundTask(count)
    assert begun.wait(PATIENCE) and task.running and task.progress.step > 0
    task.cancel()
    assert task.wait(PATIENCE) and task.result >= task.progress.step and task.error is None
