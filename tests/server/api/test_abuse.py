"""What should not happen to a server, and does: reused ids, full disks, shared stores, monstrous polygons."""

from __future__ import annotations

import gc
import json
import os
import re
import socket
import sqlite3
import sys
import time
import tracemalloc
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from compas_cgc.errors import FileError
from compas_cgc.io.rhino.meshes import mesh_from_arrays
from compas_cgc.server import create_app
from compas_cgc.server.jobs.store import Job
from compas_cgc.server.jobs.store import Store
from compas_cgc.server.limits import Limits

from ...support.server_process import KEY
from ...support.server_process import KILLABLE
from ...support.server_process import PATIENCE
from ...support.server_process import descendants
from ...support.server_process import running_server
from ...support.server_process import wait_for
from ...support.shapes import grid

ENDLESS = {"supports": "boundary", "targets": 0.5, "method": "flow", "settings": {"steps": 100000, "tolerance": 0.0, "finish": False}}


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    limits = {"containers": 20_000, "vertices": 3000}
    with running_server(tmp_path_factory.mktemp("abuse") / "jobs.sqlite", KEY, workers=1, limits=limits) as running:
        yield running


def refusal(server, **more):
    vertices, faces = grid(4)
    value = {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 0.5, **more}
    status, _, content = server.ask("POST", "/api/v1/jobs", json.dumps(value).encode())
    return status, json.loads(content).get("message", "")


def test_an_id_can_be_used_again_after_a_delete(server):
    server.client.submit(*grid(20), id="the-same-id", **ENDLESS)
    wait_for(lambda: server.client.poll("the-same-id")["iteration"] > 0)
    server.client.delete("the-same-id")
    server.client.submit(*grid(6), id="the-same-id", supports="boundary", targets=0.5)
    wait_for(lambda: server.client.poll("the-same-id")["state"] == "succeeded")
    assert len(server.client.result("the-same-id")["vertices"]) == 49


def test_faces_and_constraints_of_odd_shapes_are_refused(server):
    for faces in ([[0, 1, 2], [0, 1, [2]]], [[[0], [1], [2]]], [[0, 1, 2], [0, 1, None]]):
        status, message = refusal(server, faces=faces)
        assert status == 422 and "integers only" in message
    status, message = refusal(server, goals=[{"kind": "height", "vertices": [10**30], "height": 1}])
    assert status == 422 and "does not exist" in message
    status, message = refusal(server, faces=[[0, 1, 2, 2], [3, 3, 4, 3]])
    assert status == 422 and "faces 1 of the input" in message


def test_monstrous_polygons_keep_nobody_waiting(server):
    n = 900
    angle = 2 * np.pi * np.arange(n) / n
    rim = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle]) * (1 + 0.3 * (np.arange(n) % 2))[:, None]
    value = {"vertices": rim.tolist(), "faces": [list(range(n))], "supports": "boundary", "targets": 0.1}
    ids = [json.loads(server.ask("POST", "/api/v1/jobs", json.dumps(value).encode())[2])["id"] for _ in range(5)]
    assert server.client.health()["status"] == "ok"
    for id in ids:
        server.client.delete(id)
    wait_for(lambda: server.client.health()["busy"] == 0)


def test_a_flood_of_lists_is_refused_before_it_is_parsed(server):
    status, _, content = server.ask("POST", "/solve", b"[" + b"{}," * 20_001 + b"{}]")
    assert status == 413 and "more than 20000 lists and objects" in json.loads(content)["errors"][0]


def test_files_have_the_limits_of_requests(server):
    vertices, faces = grid(60)
    lines = [f"v {x} {y} {z}\n" for x, y, z in vertices.tolist()] + [f"f {a} {b} {c}\n" for a, b, c in (faces + 1).tolist()]
    id = server.client.submit_file("".join(lines).encode(), "obj", supports="boundary", targets=0.1)
    wait_for(lambda: server.client.poll(id)["state"] == "failed")
    status = server.client.poll(id)
    assert "the mesh has 3721 vertices" in status["message"]


def test_large_results_are_written_beside_a_busy_worker(server):
    vertices, faces = grid(50, 9.0)
    id = server.client.submit(vertices, faces, supports="boundary", targets=0.01)
    wait_for(lambda: server.client.poll(id)["state"] == "succeeded")
    busy = server.client.submit(*grid(20), **ENDLESS)
    wait_for(lambda: server.client.poll(busy)["iteration"] > 0)
    assert server.client.result(id, "3dm").startswith(b"3D Geometry File Format")
    assert json.loads(server.client.result(id, "compas"))["dtype"].endswith("CGCMesh")
    assert server.client.poll(busy)["state"] == "running"
    server.client.delete(busy)


def test_a_script_that_breaks_off_leaves_no_job_behind(server):
    def interrupt(status):
        if status["iteration"]:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        server.client.solve(*grid(20), on_progress=interrupt, interval=0.05, id="interrupted", **ENDLESS)
    wait_for(lambda: server.client.poll("interrupted")["state"] == "cancelled")


def test_a_store_belongs_to_one_server(tmp_path):
    first = Store(tmp_path / "jobs.sqlite")
    with pytest.raises(FileError, match="another server is using it"):
        Store(tmp_path / "jobs.sqlite")
    first.close()
    Store(tmp_path / "jobs.sqlite").close()


def test_a_damaged_store_is_named(tmp_path):
    (tmp_path / "garbage.sqlite").write_bytes(b"not a store at all" * 200)
    with sqlite3.connect(tmp_path / "other.sqlite") as base:
        base.execute("CREATE TABLE jobs (id TEXT)")
    (tmp_path / "folder.sqlite").mkdir()
    for name in ("other", "folder"):
        with pytest.raises(FileError, match=f"{name}.sqlite.*move the file away"):
            Store(tmp_path / f"{name}.sqlite")
    store = Store(tmp_path / "garbage.sqlite")
    assert "was damaged and is renamed to garbage.sqlite.damaged-" in store.notice and store.all() == []
    store.close()


def test_the_newest_result_is_kept_whatever_the_clock_says(tmp_path):
    store = Store(":memory:")
    for k in range(4):
        store.add(Job(f"job-{k}", "queued", time.time(), None, None, 0, "", "", "", {}, None, None), "arrays", {}, b"")
        store.finish(f"job-{k}", "succeeded", "", {}, b"result")
    store._base.execute("UPDATE jobs SET finished = finished + 3600 WHERE id != 'job-3'")
    store.tidy(2, 10**6, 100, keep="job-3")
    assert store.result("job-3") == b"result" and sum(store.result(f"job-{k}") is not None for k in range(3)) == 1


def test_a_job_whose_result_cannot_be_kept_is_reported(monkeypatch):
    from compas_cgc.server.api.requests import accept
    from compas_cgc.server.api.tasks import solve_job
    from compas_cgc.server.jobs.engine import Jobs

    def full(*args):
        raise sqlite3.OperationalError("database or disk is full")

    engine = Jobs(ThreadPoolExecutor(1), Store(":memory:"), solve_job, Limits())
    vertices, faces = grid(4)
    monkeypatch.setattr(engine.store, "finish", full)
    job, _ = engine.submit(
        "json", accept({"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 0.5}, Limits())
    )
    done = engine.wait(job.id, PATIENCE)
    assert done.state == "failed" and "its disk is full" in done.message
    engine.close()


def test_a_job_can_be_deleted_on_a_full_disk(monkeypatch):
    def full(*args):
        raise sqlite3.OperationalError("database or disk is full")

    with ThreadPoolExecutor(1) as executor:
        app = create_app(executor=executor)
        client, engine = app.test_client(), app.extensions["jobs"]
        vertices, faces = grid(4)
        request = {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 0.5, "id": "to-be-deleted"}
        assert client.post("/api/v1/jobs", data=json.dumps(request)).status_code == 202
        engine.wait("to-be-deleted", PATIENCE)
        with monkeypatch.context() as disk:
            disk.setattr(engine.store, "delete", full)
            assert client.delete("/api/v1/jobs/to-be-deleted").status_code == 204
            assert client.get("/api/v1/jobs/to-be-deleted").status_code == 404
            assert client.get("/api/v1/jobs").json["jobs"] == []
        assert client.post("/api/v1/jobs", data=json.dumps({**request, "targets": 0.4})).status_code == 202, "room again"
        assert engine.wait("to-be-deleted", PATIENCE).state == "succeeded"
        engine.close()


@pytest.mark.skipif(sys.platform == "win32", reason="it counts the bytes of a file that is open")
def test_a_deletion_makes_room_for_itself(tmp_path):
    store = Store(tmp_path / "jobs.sqlite")
    for id in ("large-one", *(f"other-{k}" for k in range(20))):
        store.add(Job(id, "queued", time.time(), None, None, 0, "", "", "", {}, None, None), "json", {}, 60_000 * b"x")
    log = tmp_path / "jobs.sqlite-wal"
    assert log.stat().st_size > 10**6
    failed = []

    class Full:
        """Raises once, as the file does where there is no room for the log to grow."""

        def __init__(self, base):
            self.base = base

        def __getattr__(self, name):
            return getattr(self.base, name)

        def __enter__(self):
            return self.base.__enter__()

        def __exit__(self, *error):
            return self.base.__exit__(*error)

        def execute(self, command, *values):
            if command.startswith("DELETE") and log.stat().st_size > 10**6:
                failed.append(command)
                raise sqlite3.OperationalError("database or disk is full")
            return self.base.execute(command, *values)

    store._base = Full(store._base)
    store.delete("large-one")
    assert failed and store.get("large-one") is None
    store.close()


def cpu_of(pid):
    """Return the CPU seconds of a process, and of the processes that it started."""
    found = descendants(pid)
    own = found.pop(pid)
    return [ticks / os.sysconf("SC_CLK_TCK") for ticks in (own, sum(found.values()))]


def forget_most_memory(pid):
    """Let the largest memory of a process start again from what it has now."""
    Path(f"/proc/{pid}/clear_refs").write_text("5")


def most_memory(pid):
    """Return the largest memory that a process has had [MB]."""
    return int(re.search(r"VmHWM:\s*(\d+)", Path(f"/proc/{pid}/status").read_text()).group(1)) / 1024


@KILLABLE
def test_large_bodies_are_parsed_by_others(server):
    pid = server.process.pid
    forget_most_memory(pid)
    before, memory = cpu_of(pid), most_memory(pid)
    flood = b'{"vertices": [' + b"[0.5,0.5,0.5]," * 9000 + b"[0,0,0]]," + b",".join(b'"key%d":1' % k for k in range(300_000)) + b"}"
    for path, number in (("/api/v1/jobs", 422), ("/solve", 404)):
        status, _, content = server.ask("POST", path, flood)
        assert status == number, content[:200]
    own, others = (after - then for after, then in zip(cpu_of(pid), before))
    assert own < 0.5 * others, "parsing takes its time in a worker"
    status, _, content = server.ask("POST", "/solve", b'{"a":' + b"[" + b"1," * 5_000_000 + b"1]," + b'"b":1,' * 1_000_000 + b'"c":1}')
    assert status == 413 and "more than 6000000 values" in json.loads(content)["errors"][0]
    huge = b"[" + b"1," * (17 * 2**20) + b"1]"
    for path in ("/api/v1/jobs", "/solve", "/io"):
        status, _, content = server.ask("POST", path, huge)
        assert status == 413 and "the JSON has 34 MB; the server accepts at most 32" in json.loads(content)["message"]
    assert most_memory(pid) - memory < 100


@pytest.mark.nightly
def test_a_large_request_is_answered_as_a_small_one(tmp_path):
    vertices, faces = grid(6, 6.0)
    value = {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 0.01, "name": "a dome"}
    mesh = json.dumps(mesh_from_arrays(vertices, faces).Encode())
    values = [{"ParamName": "Mesh", "InnerTree": {"0": [{"data": mesh}]}}, {"ParamName": "K", "InnerTree": {"0": [{"data": 0.01}]}}]
    with (
        running_server(tmp_path / "small.sqlite", workers=1) as small,
        running_server(tmp_path / "large.sqlite", workers=1, limits={"light": 10}) as large,
    ):
        answers = []
        for server in (small, large):
            id = json.loads(server.ask("POST", "/api/v1/jobs", json.dumps({**value, "id": "the-same-name"}).encode())[2])["id"]
            wait_for(lambda server=server: server.client.poll("the-same-name")["state"] == "succeeded")
            found = server.client.result(id)
            calls = []
            for name in ("dome", "submit", "nothing"):
                body = {"pointer": f"cgc/{name}", "cachesolve": True, "values": values}
                status, headers, content = server.ask("POST", "/solve", json.dumps(body).encode())
                again = server.ask("POST", "/solve", json.dumps(body).encode())
                calls.append(
                    (status, json.loads(content)["values"][:1] if name == "dome" else None, "cache" in str(again[1]["Server-Timing"]))
                )
            answers.append((id, server.client.poll(id)["name"], found["vertices"], calls))
        assert answers[0] == answers[1]
        assert [call[0] for call in answers[0][3]] == [200, 200, 404] and [call[2] for call in answers[0][3]] == [True, False, False]


def test_a_body_without_the_key_is_not_taken_in(server):
    if sys.platform == "linux":
        forget_most_memory(server.process.pid)
        memory = most_memory(server.process.pid)
    for path in ("/api/v1/jobs?kind=obj", "/solve"):
        status, _, content = server.ask("POST", path, 40 * 2**20 * b"v", RhinoComputeKey="a-wrong-key")
        assert status == 401 and "key" in json.loads(content)["message"]
    if sys.platform == "linux":
        assert most_memory(server.process.pid) - memory < 30
    with socket.create_connection(server.address.split(":"), timeout=PATIENCE) as line:
        line.sendall(b"POST /solve HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 1000\r\nExpect: 100-continue\r\n\r\n")
        said = b""
        while piece := line.recv(4096):
            said += piece
    assert said.startswith(b"HTTP/1.1 401") and b"\r\nConnection: close\r\n" in said, "at once, and nothing is asked for"
    with socket.create_connection(server.address.split(":"), timeout=PATIENCE) as line:
        key = f"RhinoComputeKey: {KEY}\r\n".encode()
        line.sendall(b"POST /solve HTTP/1.1\r\nHost: 127.0.0.1\r\n" + key + b"Content-Length: 2\r\nExpect: 100-continue\r\n\r\n")
        assert line.recv(4096).startswith(b"HTTP/1.1 100")
        line.sendall(b"{}")
        assert line.recv(4096).startswith(b"HTTP/1.1 404")


@pytest.mark.nightly
def test_nothing_of_a_large_request_is_left_when_it_is_answered():
    """Not even until Python looks for circles, which it seldom does."""
    flood = b"{" + b",".join(b'"key%d":1' % k for k in range(50_000)) + b"}"
    app = create_app(workers=1)
    client = app.test_client()
    gc.disable()
    tracemalloc.start()
    try:
        taken = []
        for _ in range(3):
            assert [client.post(path, data=flood).status_code for path in ("/solve", "/api/v1/jobs")] == [404, 422]
            taken.append(tracemalloc.get_traced_memory()[0])
        assert taken[-1] - taken[0] < len(flood)
    finally:
        tracemalloc.stop()
        gc.enable()
        app.extensions["jobs"].close()


def test_a_body_whose_reading_exceeds_a_limit_is_refused_and_not_called_a_fault_of_the_server():
    app = create_app(executor=ThreadPoolExecutor(1), limits=Limits(file_memory=1))
    try:
        answer = app.test_client().post("/api/v1/jobs", data=b"[" + b"1," * 30_000 + b"1]")
        assert (
            answer.status_code == 422 and "exceeded the memory limit" in answer.json["message"] and "smaller file" in answer.json["message"]
        )
    finally:
        app.extensions["jobs"].close()
