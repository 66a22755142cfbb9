"""Owners: every endpoint shows a key its own jobs and nobody else's."""

from __future__ import annotations

import json
import logging
import threading
import types
from concurrent.futures import ThreadPoolExecutor

import pytest

from compas_cgc.errors import CGCError
from compas_cgc.server import create_app
from compas_cgc.server import keys
from compas_cgc.server.keys import LOCAL
from compas_cgc.server.keys import Keys
from compas_cgc.server.keys import Throttle
from compas_cgc.server.keys import read_keys

from ...support.server_process import wait_for
from ...support.shapes import grid

ANNA, BEN, OPERATOR = "the-key-of-anna", "the-key-of-ben", "the-key-of-the-operator"
FILE = f'[anna]\nkey = "{ANNA}"\n[ben]\nkey = "{BEN}"\nrole = "user"\n[chief]\nkey = "{OPERATOR}"\nrole = "operator"\n'
ID = "roof-of-2026"
OPEN = ("/health", "/ready", "/version", "/openapi.json")


def body(**more):
    vertices, faces = grid(4)
    return {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 0.2, **more}


@pytest.fixture(scope="module")
def app(tmp_path_factory):
    (path := tmp_path_factory.mktemp("keys") / "keys.toml").write_text(FILE)
    app = create_app(key=read_keys(path), executor=ThreadPoolExecutor(1))
    yield app
    app.extensions["jobs"].close()


@pytest.fixture(scope="module")
def solved(app):
    """Return the id of a job of Anna's that is done."""
    client = app.test_client()
    answer = client.post("/api/v1/jobs", json=body(id=ID), headers={"RhinoComputeKey": ANNA})
    assert answer.status_code == 202
    wait_for(lambda: client.get(f"/api/v1/jobs/{ID}?wait=20", headers={"RhinoComputeKey": ANNA}).json["state"] == "succeeded")
    return ID


def pairs(app):
    """Return all pairs of method and path in the description, with the ids of a job and an example put in."""
    paths = app.test_client().get("/openapi.json").json["paths"]
    methods = ("get", "post", "put", "patch", "delete")
    return [
        (method, path.format(id=ID, name="pringle", link="0123456789abcdef", token="no-token-at-all"))
        for path, entry in paths.items()
        for method in entry
        if method in methods
    ]


def test_a_foreign_key_gets_404_at_every_address_of_a_job(app, solved):
    client = app.test_client()
    of_a_job = [(method, path) for method, path in pairs(app) if path.startswith(f"/api/v1/jobs/{ID}")]
    assert len(of_a_job) >= 8
    for method, path in of_a_job:
        answer = client.open(path, method=method.upper(), data=b"3D Geometry File Format ", headers={"RhinoComputeKey": BEN})
        assert answer.status_code == 404, (method, path)
        assert "no job" in answer.json["message"]
    assert client.get(f"/api/v1/jobs/{ID}", headers={"RhinoComputeKey": ANNA}).json["has_result"], "all is as it was"


def test_every_address_with_a_name_of_an_owner_is_tried_with_a_foreign_key(app):
    """The test above and that of designs try these; the others name examples and links, which are for all, or pages."""
    named = {rule.rule for rule in app.url_map.iter_rules() if rule.arguments}
    owned = {path for path in named if path.startswith(("/api/v1/jobs/<id>", "/api/v1/designs/<id>"))}
    described = {path.format(id="<id>", link="<link>") for path in app.test_client().get("/openapi.json").json["paths"] if "{id}" in path}
    assert owned == described and len(owned) == 9
    hops = {"/cgc/<name>", "/cgc/<name>/", "/<path:prefix>/solve"}
    assert named - owned == {"/api/v1/examples/<name>", "/api/v1/shared/<token>", "/page/<path:name>", *hops}


def test_a_foreign_key_opens_no_event_stream_of_a_job_that_is_waiting_or_over(app, solved):
    client, release = app.test_client(), threading.Event()
    app.extensions["jobs"].executor.submit(release.wait)
    try:
        waiting = client.post("/api/v1/jobs", json=body(targets=0.15), headers={"RhinoComputeKey": ANNA}).json["id"]
        for id in [waiting, *20 * [solved]]:  # more than there may be streams
            answer = client.get(f"/api/v1/jobs/{id}/events", headers={"RhinoComputeKey": BEN})
            assert answer.status_code == 404 and answer.mimetype == "application/json" and "no job" in answer.json["message"]
        assert client.get(f"/api/v1/jobs/{waiting}", headers={"RhinoComputeKey": ANNA}).json["state"] == "queued"
        client.delete(f"/api/v1/jobs/{waiting}", headers={"RhinoComputeKey": ANNA})
    finally:
        release.set()
    assert b"event: done" in client.get(f"/api/v1/jobs/{solved}/events", headers={"RhinoComputeKey": ANNA}).data


def test_the_log_holds_every_attempt_with_a_foreign_key_by_its_name(app, solved, caplog):
    client = app.test_client()
    of_a_job = [(method.upper(), path) for method, path in pairs(app) if path.startswith(f"/api/v1/jobs/{ID}")]
    with caplog.at_level(logging.INFO, "compas_cgc.server.requests"):
        for method, path in of_a_job:
            client.open(path, method=method, data=b"3D Geometry File Format ", headers={"RhinoComputeKey": BEN})
    lines = [record.getMessage() for record in caplog.records if record.name == "compas_cgc.server.requests"]
    assert lines == [f"key:ben {method} {path}: 404" for method, path in of_a_job]
    assert BEN not in caplog.text


def test_the_log_names_an_operator_and_the_owner_it_acts_for(app, solved, caplog):
    client = app.test_client()
    with caplog.at_level(logging.INFO, "compas_cgc.server.requests"):
        client.get(f"/api/v1/jobs/{ID}", headers={"RhinoComputeKey": OPERATOR, "CGC-Owner": "anna"})
        client.get(f"/api/v1/jobs/{ID}", headers={"RhinoComputeKey": BEN, "CGC-Owner": "anna"})
    for_anna, refused = (record.fields for record in caplog.records)
    assert (for_anna["client"], for_anna["owner"], for_anna["status"]) == ("key:chief", "anna", 200)
    assert (refused["client"], refused["owner"], refused["status"]) == ("key:ben", "ben", 403)


def test_nothing_but_descriptions_is_answered_without_a_key(app, solved):
    client = app.test_client()
    for method, path in pairs(app):
        answer = client.open(path, method=method.upper())
        wanted = 200 if path in OPEN else 404 if path.startswith("/api/v1/shared/") else 401
        assert answer.status_code == wanted, (method, path)
    assert client.get("/cgc/dome").status_code == 200
    assert client.get("/metrics").status_code == 401


def test_a_list_holds_the_jobs_of_its_owner_alone(app, solved):
    client = app.test_client()
    lists = [client.get("/api/v1/jobs", headers={"Authorization": f"Bearer {key}"}).json for key in (ANNA, BEN, OPERATOR)]
    assert [job["id"] for job in lists[0]["jobs"]] == [ID] and lists[0]["total"] == 1
    assert [found["total"] for found in lists[1:]] == [0, 0]


def test_two_owners_may_use_the_same_id(app, solved):
    client = app.test_client()
    theirs = client.post("/api/v1/jobs", json=body(id=ID, targets=0.1), headers={"RhinoComputeKey": BEN})
    assert theirs.status_code == 202, "no conflict with the request of another owner"
    assert client.post("/api/v1/jobs", json=body(id=ID, targets=0.1), headers={"RhinoComputeKey": ANNA}).status_code == 409
    wait_for(lambda: client.get(f"/api/v1/jobs/{ID}?wait=20", headers={"RhinoComputeKey": BEN}).json["state"] == "succeeded")
    results = [client.get(f"/api/v1/jobs/{ID}/result", headers={"RhinoComputeKey": key}).json for key in (ANNA, BEN)]
    assert results[0]["vertices"] != results[1]["vertices"]
    assert client.delete(f"/api/v1/jobs/{ID}", headers={"RhinoComputeKey": BEN}).status_code == 204
    assert client.get(f"/api/v1/jobs/{ID}", headers={"RhinoComputeKey": ANNA}).status_code == 200


def test_a_task_on_the_result_of_another_owner_is_refused(app, solved):
    given = {"task": "unroll", "job": ID}
    answer = app.test_client().post("/api/v1/jobs", json=given, headers={"RhinoComputeKey": BEN})
    assert answer.status_code == 404


def test_hops_fetches_the_jobs_of_its_key_alone(app, solved):
    def fetched(key):
        values = [{"ParamName": name, "InnerTree": {"{0}": [{"data": data}]}} for name, data in (("Job", f'"{ID}"'), ("Tick", "1"))]
        return app.test_client().post("/solve", json={"pointer": "cgc/fetch", "values": values}, headers={"RhinoComputeKey": key})

    assert fetched(ANNA).status_code == 200
    assert fetched(BEN).status_code == 404


def test_an_operator_acts_for_an_owner_by_name_and_nobody_else_does(app, solved):
    client = app.test_client()
    assert client.get(f"/api/v1/jobs/{ID}", headers={"RhinoComputeKey": OPERATOR}).status_code == 404
    named = {"CGC-Owner": "anna"}
    assert client.get(f"/api/v1/jobs/{ID}", headers={"RhinoComputeKey": OPERATOR, **named}).status_code == 200
    assert client.get(f"/api/v1/jobs/{ID}", headers={"RhinoComputeKey": BEN, **named}).status_code == 403


def test_requests_are_logged_by_the_name_of_the_key(app, solved, caplog):
    with caplog.at_level(logging.INFO, "compas_cgc.server.requests"):
        app.test_client().get(f"/api/v1/jobs/{ID}", headers={"RhinoComputeKey": ANNA})
    assert f"key:anna GET /api/v1/jobs/{ID}: 200" in caplog.text and ANNA not in caplog.text


def test_without_keys_this_machine_is_one_owner():
    app = create_app(executor=ThreadPoolExecutor(1))
    client = app.test_client()
    assert client.post("/api/v1/jobs", json=body(id=ID), environ_base={"REMOTE_ADDR": "127.0.0.1"}).status_code == 202
    assert client.get(f"/api/v1/jobs/{ID}", environ_base={"REMOTE_ADDR": "127.0.0.2"}).status_code == 200
    assert client.get("/api/v1/jobs/anna:roof").status_code == 404
    app.extensions["jobs"].close()


def test_an_address_that_tries_many_keys_has_to_wait():
    app = create_app(key=Keys(["the-only-right-key"]), executor=ThreadPoolExecutor(1))
    client = app.test_client()
    codes = [client.get("/api/v1/jobs", headers={"RhinoComputeKey": f"wrong-{k}"}).status_code for k in range(25)]
    assert codes == 20 * [401] + 5 * [429]
    answer = client.get("/api/v1/jobs", headers={"RhinoComputeKey": "the-only-right-key"})
    assert answer.status_code == 429 and int(answer.headers["Retry-After"]) > 30, "or every key could be tried"
    elsewhere = {"environ_base": {"REMOTE_ADDR": "192.0.2.7"}}
    assert client.get("/api/v1/jobs", headers={"RhinoComputeKey": "the-only-right-key"}, **elsewhere).status_code == 200
    app.extensions["jobs"].close()


def test_a_throttle_lets_go_after_its_window(monkeypatch):
    throttle, now = Throttle(attempts=2, window=60.0), [0.0]
    monkeypatch.setattr(keys, "time", types.SimpleNamespace(monotonic=lambda: now[0]))
    throttle.add("a")
    assert throttle.pause("a") == 0.0
    now[0] = 20.0
    throttle.add("a")
    assert throttle.pause("a") == 40.0 and throttle.pause("b") == 0.0
    now[0] = 61.0
    assert throttle.pause("a") == 0.0


@pytest.mark.parametrize(
    "text, sentence",
    [
        ("", "holds no key"),
        ("[anna", "cannot be read"),
        ("[anna]\n", "must hold key or sha256"),
        ('[anna]\nkey = "short"\n', "at least 8 printable"),
        ('[anna]\nkey = "long-enough"\nrole = "chief"\n', "must be user or operator, not 'chief'"),
        ('["an na"]\nkey = "long-enough"\n', "must be 1 to 40 letters"),
        ('[anna]\nsha256 = "12"\n', "64 hexadecimal digits"),
        ('[anna]\nkey = "long-enough"\n[ben]\nkey = "long-enough"\n', "two owners have the same key"),
    ],
)
def test_a_wrong_file_of_keys_is_one_sentence(tmp_path, text, sentence):
    (path := tmp_path / "keys.toml").write_text(text)
    with pytest.raises(CGCError, match=sentence):
        read_keys(path)


def test_keys_are_found_by_their_hash_and_never_kept(tmp_path):
    keys = Keys(["first-of-two-keys", "second-of-two-keys"])
    (path := tmp_path / "keys.toml").write_text(f'[anna]\nsha256 = "{keys[0].digest.hex()}"\n')
    assert read_keys(path).find("", "Bearer first-of-two-keys") == ("anna", "user", keys[0].digest)
    assert keys.find("second-of-two-keys", "").name.startswith("key-") and keys.find("", "Basic first-of-two-keys") is None
    assert Keys("one-key-alone").find("one-key-alone", "")[:2] == LOCAL[:2]
    assert "first-of-two-keys" not in repr(json.dumps([repr(key) for key in keys]))
