"""Servers and workers that are killed: every job is finished all the same, and comes out the same.

``KILLS=10`` kills more often than the few times of every day.
"""

from __future__ import annotations

import json
import os
import random
import re
import signal
import sqlite3
import time

import pytest

from compas_cgc.client import Refused

from ..support.dask_cluster import dask_cluster
from ..support.dask_cluster import kill
from ..support.server_process import KILLABLE
from ..support.server_process import PATIENCE
from ..support.server_process import running_server
from ..support.server_process import wait_for
from ..support.server_process import worker_of
from ..support.shapes import grid

pytestmark = [KILLABLE, pytest.mark.nightly]
KILLS = int(os.environ.get("KILLS", 2))


def job(n=6, **more):
    vertices, faces = grid(n)
    return {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 0.5, **more}


def submit(server, value):
    return server.ask("POST", "/api/v1/jobs", json.dumps(value).encode())[0]


JOBS = {
    "a-long-one": job(20, method="flow", settings={"steps": 1000, "tolerance": 0.0}),
    "small-one": job(8),
    "small-two": job(9, targets=0.3),
    "small-three": job(7, targets=0.2, method="projection"),
}


def figures(result):
    """Return a result without what depends on the clock."""
    return {name: value for name, value in result.items() if name not in ("id", "seconds", "name")}


def check_store(store):
    base = sqlite3.connect(store)
    try:
        assert base.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
    finally:
        base.close()


@pytest.fixture(scope="module")
def clean(tmp_path_factory):
    """The results of the jobs when nothing is killed."""
    with running_server(tmp_path_factory.mktemp("clean") / "jobs.sqlite", workers=1) as server:
        for name, value in JOBS.items():
            assert submit(server, {**value, "id": f"{name}-clean"}) == 202
        wait_for(lambda: all(status["state"] == "succeeded" for status in server.client.jobs()))
        return {name: figures(server.client.result(f"{name}-clean")) for name in JOBS}


def test_jobs_outlive_kills_of_the_server_and_come_out_the_same(tmp_path, clean):
    store, chance = tmp_path / "jobs.sqlite", random.Random(1)
    for attempt in range(KILLS):
        with running_server(store, workers=1) as server:
            for name, value in JOBS.items():
                assert submit(server, {**value, "id": f"{name}-{attempt}"}) == 202
            if attempt % 2 == 0:
                wait_for(lambda attempt=attempt: server.client.poll(f"a-long-one-{attempt}")["iteration"] > 0)
            time.sleep(chance.uniform(0.0, 0.3))
            server.process.kill()
            server.process.wait(PATIENCE)
        check_store(store)
    # Those of the last kill are finished now, those before it after the kill that followed theirs.
    with running_server(store, workers=1) as server:
        wait_for(lambda: all(status["state"] not in ("queued", "running") for status in server.client.jobs()))
        for attempt in range(KILLS):
            for name in JOBS:
                status = server.client.poll(f"{name}-{attempt}")
                if status["state"] == "failed":
                    assert re.match(r"the server crashed \d times during this job", status["message"])
                else:
                    assert status["state"] == "succeeded"
                    assert figures(server.client.result(status["id"])) == clean[name], (name, attempt)
        assert server.client.poll(f"a-long-one-{KILLS - 1}")["state"] == "succeeded"
    check_store(store)


def test_a_killed_worker_takes_only_its_own_job_with_it(tmp_path, clean):
    store = tmp_path / "jobs.sqlite"
    with running_server(store, workers=1) as server:
        for attempt in range(KILLS):
            for name, value in JOBS.items():
                assert submit(server, {**value, "id": f"{name}-{attempt}"}) == 202
            wait_for(lambda attempt=attempt: server.client.poll(f"a-long-one-{attempt}")["iteration"] > 0)
            worker = worker_of(server)
            os.kill(worker, signal.SIGKILL)
            # What waits for a solve is told too.
            wait_for(lambda attempt=attempt: server.client.poll(f"small-three-{attempt}")["state"] == "succeeded")
            status = server.client.poll(f"a-long-one-{attempt}")
            assert status["state"] == "failed" and "killed by signal 9" in status["message"] and "submit the job again" in status["message"]
            with pytest.raises(Refused, match="killed by signal 9"):
                server.client.result(status["id"])
            for name in ("small-one", "small-two", "small-three"):
                assert figures(server.client.result(f"{name}-{attempt}")) == clean[name]
            health = server.client.health()
            assert health == {**health, "replaced": attempt + 1, "idle": health["workers"], "status": "ok"}
        submit(server, {**JOBS["a-long-one"], "id": "once-again"})
        wait_for(lambda: server.client.poll("once-again")["state"] == "succeeded")
        assert figures(server.client.result("once-again")) == clean["a-long-one"]
    check_store(store)


def outcomes_of(server, names, clean):
    """Wait for jobs, submit those that failed again until they do not, and compare; return how many failed on the way."""
    failed = 0
    left = dict(names)
    while left:
        for id in left.values():
            wait_for(lambda id=id: server.client.poll(id)["state"] not in ("queued", "running"))
        again = {}
        for name, id in left.items():
            status = server.client.poll(id)
            if status["state"] == "failed":
                assert re.search(r"ended (unexpectedly|\d times)", status["message"]), status["message"]
                failed += 1
                again[name] = f"{id}-again"
                assert submit(server, {**JOBS[name], "id": again[name]}) == 202
            else:
                assert status["state"] == "succeeded" and figures(server.client.result(id)) == clean[name], (name, status)
        left = again
    return failed


@pytest.mark.timeout(1800)
def test_on_a_dask_cluster_workers_scheduler_and_server_are_killed_and_every_job_is_finished_or_reported(tmp_path, clean):
    pytest.importorskip("distributed", reason="distributed is not installed: pip install 'compas_cgc[dask]'")
    store, chance = tmp_path / "jobs.sqlite", random.Random(2)
    with dask_cluster(2) as cluster:

        def submitted(server, kind, attempt):
            names = {name: f"{name}-{kind}-{attempt}" for name in JOBS}
            for name, id in names.items():
                assert submit(server, {**JOBS[name], "id": id}) == 202
            wait_for(lambda: server.client.poll(names["a-long-one"])["iteration"] > 0)
            assert server.client.poll(names["a-long-one"])["state"] == "running"
            time.sleep(chance.uniform(0.0, 0.3))
            return names

        with running_server(store, limits={}, executor=cluster.address) as server:
            for attempt in range(KILLS):
                names = submitted(server, "worker", attempt)
                kill(cluster.workers[attempt % 2])
                cluster.workers[attempt % 2] = cluster.add_worker()
                cluster.workers.pop()
                assert outcomes_of(server, names, clean) <= 1
            for attempt in range(KILLS):
                names = submitted(server, "scheduler", attempt)
                kill(cluster.scheduler)
                for worker in cluster.workers:
                    kill(worker)
                cluster.restart_scheduler()
                cluster.workers = [cluster.add_worker(), cluster.add_worker()][:2]
                assert outcomes_of(server, names, clean) <= 1, server.said
        for attempt in range(KILLS):
            with running_server(store, limits={}, executor=cluster.address) as server:
                names = submitted(server, "server", attempt)
                server.process.kill()
                server.process.wait(PATIENCE)
            check_store(store)
            with running_server(store, limits={}, executor=cluster.address) as server:
                assert outcomes_of(server, names, clean) == 0
