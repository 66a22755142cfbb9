"""Readiness, metrics, logs and configuration of a server."""

from __future__ import annotations

import json
import logging
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest
from prometheus_client.parser import text_string_to_metric_families

from compas_cgc.errors import CGCError
from compas_cgc.server import Limits
from compas_cgc.server import create_app
from compas_cgc.server.keys import Keys
from compas_cgc.server.keys import read_keys
from compas_cgc.server.operation.configuration import read_configuration
from compas_cgc.server.operation.logs import JSONLines
from compas_cgc.server.operation.readiness import Readiness

from ...support.server_process import wait_for
from ...support.shapes import grid

USER, CHIEF = "the-key-of-a-user", "the-key-of-the-chief"


def body(**more):
    vertices, faces = grid(4)
    return {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 0.2, **more}


@pytest.fixture
def app(tmp_path):
    (path := tmp_path / "keys.toml").write_text(f'[anna]\nkey = "{USER}"\n[chief]\nkey = "{CHIEF}"\nrole = "operator"\n')
    app = create_app(tmp_path / "jobs.sqlite", key=read_keys(path), executor=ThreadPoolExecutor(1))
    yield app
    app.extensions["jobs"].close()


def samples(client):
    answer = client.get("/metrics", headers={"Authorization": f"Bearer {CHIEF}"})
    assert answer.status_code == 200 and answer.content_type.startswith("text/plain; version=0.0.4")
    families = text_string_to_metric_families(answer.get_data(as_text=True))
    return {(own.name, *sorted(own.labels.items())): own.value for family in families for own in family.samples}


def test_metrics_count_requests_and_jobs_and_belong_to_the_operator(app):
    client = app.test_client()
    user = {"RhinoComputeKey": USER}
    assert client.get("/metrics").status_code == 401 and client.get("/metrics", headers=user).status_code == 403
    id = client.post("/api/v1/jobs", json=body(), headers=user).json["id"]
    wait_for(lambda: client.get(f"/api/v1/jobs/{id}?wait=20", headers=user).json["state"] == "succeeded")
    client.open("/api/v1/jobs", method="ODDITY", headers=user)
    found = samples(client)
    assert found["cgc_jobs_finished_total", ("state", "succeeded")] == 1
    assert found["cgc_jobs", ("state", "running")] == 0
    key = ("address", "/api/v1/jobs/<id>"), ("method", "GET"), ("status", "200")
    assert found[("cgc_requests_total", *key)] == 1, "one line for all jobs"
    assert not any(label == ("method", "ODDITY") for name, *labels in found for label in labels)
    assert found["cgc_request_seconds_count", ("address", "/metrics")] == 2
    assert found["cgc_request_seconds_sum", ("address", "/api/v1/jobs")] > 1e-4, "jobs are written to the disk"
    assert found["cgc_store_bytes",] > 0 and found["cgc_disk_free_bytes",] > 0


def test_ready_tells_of_a_full_disk_a_broken_store_and_the_end(app, monkeypatch):
    client, jobs = app.test_client(), app.extensions["jobs"]
    assert client.get("/ready").json == {"ready": True, "problems": []}
    monkeypatch.setattr(jobs.store, "free", lambda: 10 * 2**20)
    monkeypatch.setattr(jobs.store, "check", lambda: "the store cannot be written to (disk I/O error)")
    answer = wait_for(lambda: (found := client.get("/ready")).status_code != 200 and found)
    assert answer.status_code == 503
    assert answer.json["problems"] == [
        "the store cannot be written to (disk I/O error)",
        "the disk has 10 MB left, 256 MB are needed",
    ]


def test_ready_does_not_wait_for_a_disk_that_hangs():
    responds, ended = threading.Event(), []
    own = Readiness(lambda: ended.append(responds.wait()) or [], patience=0.2, max_age=0.0)
    assert own.problems() == own.problems() == ["the store did not respond within 0.2 s"] and not ended
    responds.set()
    wait_for(lambda: not own.problems())


def test_many_questions_are_one_check():
    count = []
    own = Readiness(lambda: count.append(1) or [], max_age=60.0)
    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(lambda _: own.problems(), range(100))) == [[]] * 100
    assert len(count) == 1


def test_logs_are_json_lines_with_time_client_and_request_id(app, caplog):
    caplog.set_level(logging.INFO, "compas_cgc")
    client = app.test_client()
    answer = client.get("/api/v1/jobs", headers={"RhinoComputeKey": USER, "X-Request-ID": "office-42"})
    assert answer.headers["X-Request-ID"] == "office-42"
    line = json.loads(JSONLines().format(caplog.records[-1]))
    assert line.pop("seconds") >= 0 and line.pop("time").endswith("Z") and line.pop("bytes_out") > 0
    assert line == {
        "level": "info",
        "logger": "compas_cgc.server.requests",
        "message": "key:anna GET /api/v1/jobs: 200",
        "client": "key:anna",
        "owner": "anna",
        "method": "GET",
        "path": "/api/v1/jobs",
        "status": 200,
        "bytes_in": 0,
        "request": "office-42",
    }
    forged = client.get("/version", headers={"X-Request-ID": 'a"b c'}).headers["X-Request-ID"]
    assert forged != 'a"b c' and len(forged) == 16
    assert USER not in caplog.text


def test_an_error_in_the_server_names_its_request(app, monkeypatch, caplog):
    monkeypatch.setattr(app.extensions["jobs"], "page", None)
    answer = app.test_client().get("/api/v1/jobs", headers={"RhinoComputeKey": USER, "X-Request-ID": "office-43"})
    assert answer.status_code == 500 and "request office-43 in its log" in answer.json["message"]


CONFIGURATION = """
host = "0.0.0.0"
port = 8000
keys = "keys.toml"
names = ["studio-pc"]
store = "state/jobs.sqlite"
log = "json"

[limits]
queue = 12
days = 30
seconds = 600.5
"""


def test_a_configuration_holds_options_limits_and_paths_relative_to_it(tmp_path):
    (path := tmp_path / "cgc.toml").write_text(CONFIGURATION)
    found = read_configuration(path)
    assert found["limits"] == Limits(queue=12, days=30, seconds=600.5)
    assert found["store"] == str(tmp_path / "state" / "jobs.sqlite") and found["keys"] == str(tmp_path / "keys.toml")
    assert (found["host"], found["port"], found["names"], found["log"]) == ("0.0.0.0", 8000, ["studio-pc"], "json")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("hosts = 'a'", "unknown option 'hosts'; did you mean host?"),
        ("port = '80'", "port must be a whole number, not '80'"),
        ("port = 70000", "port must be from 0 to 65535, not 70000"),
        ("names = [1]", "names must be a list of texts"),
        ("log = 'xml'", "log must be text or json"),
        ("[limits]\nqueues = 3", "unknown limit 'queues'; did you mean queue?"),
        ("[limits]\nqueue = 0", "the limit queue must be a whole number from 1 up, not 0"),
        ("[limits]\nqueue = true", "the limit queue must be a whole number"),
        ("[limits]\ndays = nan", "the limit days must be a number greater than 0, not nan"),
        ("port = ", "cannot be read"),
    ],
)
def test_a_mistake_in_the_configuration_is_one_sentence(tmp_path, text, message):
    (path := tmp_path / "cgc.toml").write_text(text)
    with pytest.raises(CGCError, match="cgc.toml") as caught:
        read_configuration(path)
    assert message in str(caught.value)


def test_one_key_belongs_to_the_operator():
    app = create_app(key=Keys(CHIEF), executor=ThreadPoolExecutor(1))
    assert app.test_client().get("/metrics", headers={"RhinoComputeKey": CHIEF}).status_code == 200
    app.extensions["jobs"].close()
