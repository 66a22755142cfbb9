"""Solve and Server against a real server: a solve there, progress, cancel, and a server that is lost and comes back."""

from __future__ import annotations

import sys
import threading
import time

import numpy as np
import pytest

from compas_cgc import CGCMesh
from compas_cgc import FlowSettings
from compas_cgc import Height
from compas_cgc import Unknown
from compas_cgc.grasshopper.components import server as server_component
from compas_cgc.grasshopper.runtime import remote_solve as remote_module
from compas_cgc.grasshopper.runtime.address import Address
from compas_cgc.grasshopper.runtime.background import BackgroundTask
from compas_cgc.grasshopper.runtime.local_solve import local_solve
from compas_cgc.grasshopper.runtime.remote_solve import request_body

from ...support.gh_stand_ins import place
from ...support.gh_stand_ins import rhino  # noqa: F401
from ...support.server_process import PATIENCE
from ...support.server_process import free_port
from ...support.server_process import running_server
from ...support.server_process import wait_for
from .test_solve import dome
from .test_solve import endless
from .test_solve import gate  # noqa: F401
from .test_solve import task_of
from .test_solve import until_done

pytestmark = pytest.mark.usefixtures("rhino")


def states(running):
    return {job["id"]: job["state"] for job in running.client.jobs()}


def here(mesh, settings=None, goals=()):
    return local_solve(mesh, settings, goals)(lambda progress: False)


def test_the_server_gives_what_this_process_gives(open_server, gate):  # noqa: F811
    placed = place("Solve")
    outs = until_done(placed, gate, cgc_mesh=dome(), run=True, server=open_server.url)
    assert outs[0]["status"] == "running" and outs[-1]["status"] == "converged" and not placed.component.balloons
    own = here(dome())
    assert [list(p) for p in outs[-1]["mesh"].Vertices] == own.mesh.arrays()[0].tolist(), "bit by bit"
    assert "max error" in outs[-1]["report"] and len(place("History").run(result=outs[-1]["result"])["energy"]) == len(own.history.energy)


def test_creases_strategies_and_dummies_arrive_there(open_server):
    mesh = CGCMesh.from_meshgrid(dx=6, nx=6)
    mesh.set_supports("corners")
    mesh.set_creases([[7 * i + 3 for i in range(7)]])
    mesh.set_target(0.02)
    plain = request_body("id", mesh.to_problem())
    assert b'"creases": [[3, 10]' in plain and b'"dtype"' not in plain
    single, ringed = mesh.copy(), mesh.copy()
    single.set_strategy(s=0.5)
    ringed.add_dummy_ring()
    for posed in (mesh, single, ringed):
        out = until_done(place("Solve"), cgc_mesh=posed, run=True, server=Address(open_server.url))[-1]
        assert out["status"] == "converged" and out["cgc_mesh"].creases() == mesh.creases()
        assert out["cgc_mesh"].arrays()[0].tolist() == here(posed).mesh.arrays()[0].tolist()


def test_settings_and_constraints_go_along(open_server):
    placed = place("Solve")
    inputs = dict(cgc_mesh=dome(), run=True, server=open_server.url)
    assert until_done(placed, settings=FlowSettings(steps=5, finish=False), **inputs)[-1]["status"] == "step_limit"
    before = len(states(open_server))
    out = until_done(placed, goals=[Height([44], 1.0)], **inputs)[-1]
    assert out["status"] == "converged" and len(states(open_server)) == before + 1
    assert out["cgc_mesh"].vertex_coordinates(44)[2] == pytest.approx(1.0, abs=1e-9)
    own = here(dome(), None, [Height([44], 1.0)])
    assert np.array_equal(out["result"].vertices, own.vertices) and out["result"].method == own.method


def test_constraints_of_the_mesh_go_along_once(open_server):
    mesh = dome()
    mesh.set_goals([Height([44], 0.9), Unknown()])
    ringed = mesh.copy()
    ringed.add_dummy_ring()
    for posed in (mesh, ringed):
        assert request_body("id", posed.to_problem()).count(b'"kind": "height"') == 1
        out = until_done(place("Solve"), cgc_mesh=posed, run=True, server=open_server.url)[-1]
        assert out["cgc_mesh"].vertex_coordinates(44)[2] == pytest.approx(0.9, abs=1e-9) and out["status"] == "converged"
        assert [goal.height for goal in out["cgc_mesh"].goals() if isinstance(goal, Height)] == [0.9]
        assert np.array_equal(out["result"].vertices, here(posed).vertices)


def test_the_result_of_a_server_is_like_that_of_this_process(open_server):
    settings = FlowSettings(steps=5, finish=False)
    there = until_done(place("Solve"), cgc_mesh=dome(), settings=settings, run=True, server=open_server.url)[-1]["result"]
    own = here(dome(), settings)
    words, same = there.to_dict(), own.to_dict()
    assert words.pop("seconds") >= 0 and same.pop("seconds") >= 0 and words == same
    assert all(a.dtype == b.dtype for a, b in zip(there.history, own.history)) and isinstance(there.mesh, CGCMesh)
    assert there.problem.roles.tolist() == own.problem.roles.tolist() and there.problem.names[0].tolist() == own.problem.names[0].tolist()


def test_a_refusal_of_the_server_is_a_red_balloon(open_server):
    placed = place("Solve")
    assert until_done(placed, cgc_mesh=dome(K=0.5), run=True, server=open_server.url)[-1]["status"] == "refused"
    assert "too large for this boundary" in placed.said("Error")[0]
    huge = FlowSettings(steps=10**9)
    assert until_done(placed, cgc_mesh=dome(), settings=huge, run=True, server=open_server.url)[-1]["status"] == "refused"
    assert "the server allows at most" in placed.said("Error")[0]


def busy():
    return dict(cgc_mesh=endless()["cgc_mesh"], settings=FlowSettings(steps=100000, tolerance=0.0, finish=False))


def test_a_newer_input_cancels_the_job_on_the_server(open_server):
    placed = place("Solve")
    placed.run(run=True, server=open_server.url, **busy())
    wait_for(lambda: "running" in states(open_server).values())
    (job,) = [id for id, state in states(open_server).items() if state == "running"]
    done = until_done(placed, cgc_mesh=dome(), run=True, server=open_server.url)
    assert done[-1]["status"] == "converged"
    wait_for(lambda: states(open_server)[job] == "cancelled")


def test_reset_cancels_the_job_on_the_server(open_server):
    placed = place("Solve")
    placed.run(run=True, server=open_server.url, **busy())
    wait_for(lambda: "running" in states(open_server).values())
    wait_for(lambda: placed.run(run=True, server=open_server.url, **busy())["progress"] is not None)
    placed.run(reset=True)
    wait_for(lambda: "running" not in states(open_server).values())


def test_a_job_is_cancelled_also_while_the_server_is_slow(monkeypatch):
    asked, cancelled, over = threading.Event(), [], threading.Event()

    class Slow:
        def __init__(self, *args, **options):
            pass

        def request(self, method, path, body):
            pass

        def poll(self, id):
            asked.set()
            while not over.is_set():
                time.sleep(0.01)

        def cancel(self, id):
            cancelled.append(id)

    monkeypatch.setattr(remote_module, "Client", Slow)
    task = BackgroundTask(remote_module.remote_solve(dome().to_problem(), None, (), Address("http://studio-pc:7331")))
    assert asked.wait(PATIENCE)
    task.cancel()
    assert task.wait(PATIENCE), "it does not wait for the answer"
    wait_for(lambda: cancelled)
    over.set()


@pytest.mark.nightly
def test_a_server_that_is_lost_and_comes_back(tmp_path, monkeypatch):
    monkeypatch.setattr("compas_cgc.grasshopper.runtime.remote_solve.RETRY_INTERVAL", 0.1)
    placed, port = place("Solve"), free_port()
    url = f"http://127.0.0.1:{port}"
    inputs = dict(run=True, server=url, **busy())
    placed.run(**inputs)
    task = task_of(placed)
    wait_for(lambda: task.progress.note)
    assert placed.run(**inputs)["status"] == "running" and placed.component.Message == "waiting"
    assert "start one with: compas-cgc serve; retrying" in placed.said("Warning")[0]
    with running_server(tmp_path / "first.sqlite", workers=1, port=port):
        wait_for(lambda: task.progress.step > 0)
        assert placed.run(**inputs)["status"] == "running" and not placed.component.balloons
    wait_for(lambda: task.progress.note)
    # Another server knows nothing of the job and gets it again.
    with running_server(tmp_path / "second.sqlite", workers=1, port=port) as second:
        wait_for(lambda: "running" in states(second).values())
        assert task.running
        placed.run(reset=True)
        wait_for(lambda: "running" not in states(second).values())


# ----------------------------------------------------------------------
# The component Server
# ----------------------------------------------------------------------


def settled(placed, **inputs):
    out = placed.run(**inputs)
    end = time.monotonic() + PATIENCE
    while placed.component.document.scheduled:
        assert time.monotonic() < end
        time.sleep(0.05)
        placed.component.document.tick()
        out = placed.run(**inputs)
    return out


def test_a_server_that_runs_is_found_and_left_alone(open_server):
    placed = place("Server")
    out = settled(placed, run=True, url=open_server.url)
    assert out["server"] == Address(open_server.url) and out["url"] == open_server.url and out["status"].endswith("already running")
    assert place("Solve").run(cgc_mesh=dome(), run=False, server=out["server"])["status"] == "waiting"
    assert settled(placed, run=False, url=open_server.url)["status"] == "not running"
    assert open_server.client.health()["status"] == "ok"


@pytest.mark.nightly
def test_a_server_is_started_and_stopped_with_the_toggle(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path))
    placed, url = place("Server"), f"http://127.0.0.1:{free_port()}"
    first = placed.run(run=True, url=url, python=sys.executable)
    assert first["server"] is None and placed.component.Message == "starting"
    out = settled(placed, run=True, url=url, python=sys.executable)
    assert out["status"].endswith("started here") and placed.component.Message == "running"
    process = server_component._MEMORIES.of(placed.component).task.result.process
    assert until_done(place("Solve"), cgc_mesh=dome(), run=True, server=out["server"])[-1]["status"] == "converged"
    assert settled(placed, run=False, url=url)["status"] == "not running"
    assert process.wait(PATIENCE) is not None


@pytest.mark.parametrize(
    "inputs, sentence",
    [
        ({"url": "http://127.0.0.1:PORT", "python": "/nowhere/python"}, "cannot be run"),
        ({"url": "http://127.0.0.1:PORT", "python": sys.executable, "key": "short"}, "the server did not start"),
        ({"url": "http://cgc.invalid:7331"}, "only be started on this machine"),
    ],
)
def test_a_server_that_cannot_start_says_why(inputs, sentence):
    placed = place("Server")
    inputs["url"] = inputs["url"].replace("PORT", str(free_port()))
    out = settled(placed, run=True, **inputs)
    assert out["server"] is None and sentence in placed.said("Error")[0] and placed.component.Message == "not running"
    placed.run(run=False)


def test_inside_rhino_a_python_must_be_named(monkeypatch):
    monkeypatch.setattr(sys, "executable", "C:/Program Files/Rhino 8/System/Rhino.exe")
    placed = place("Server")
    settled(placed, run=True, url=f"http://127.0.0.1:{free_port()}")
    assert "Rhino cannot start one" in placed.said("Error")[0]
    placed.run(run=False)
