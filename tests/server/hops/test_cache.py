"""Answers kept by the server ("Cache On Server"): the same bytes again, and never a stale or a failed one."""

from __future__ import annotations

import json

import pytest

from compas_cgc.io.rhino.meshes import mesh_from_arrays
from compas_cgc.server.hops.cache import Answers
from compas_cgc.server.hops.cache import request_digest

from ...support.hops_client import Hops
from ...support.shapes import grid


def body_of(server, name="dome", cachesolve=True, n=6, **inputs):
    body = Hops(f"{server.url}/cgc/{name}").request(Mesh=mesh_from_arrays(*grid(n, 6.0)), **inputs)
    return {**body, "cachesolve": cachesolve}


def post(server, body):
    """Return status, whether the answer was kept, and its bytes."""
    status, headers, content = server.ask("POST", "/solve", json.dumps(body).encode())
    return status, "cache;desc=hit" in (headers["Server-Timing"] or ""), content


@pytest.mark.parametrize("name, inputs", [("dome", {"K": 0.011}), ("flow", {"K": 0.011}), ("analyse", {}), ("solve", {"K": [0.011]})])
def test_the_same_again_is_answered_with_the_same_bytes(server, name, inputs):
    body = body_of(server, name, **inputs)
    status, kept, first = post(server, body)
    assert (status, kept) == (200, False)
    # What has no part in the answer has none in the key.
    assert post(server, {**body, "pointer": f"http://elsewhere/cgc/{name}", "dataversion": 8, "warnings": ["none"]}) == (200, True, first)


@pytest.mark.parametrize("flag", [False, None, 1, "true"])
def test_nothing_is_kept_for_those_who_do_not_ask(server, flag):
    body = body_of(server, cachesolve=flag, K=0.0121 + 1e-4 * [False, None, 1, "true"].index(flag))
    assert [post(server, body)[1] for _ in range(2)] == [False, False]
    assert post(server, {**body, "cachesolve": True})[1] is False, "and nothing was kept for others"


def test_whatever_the_answer_depends_on_is_part_of_the_question(server):
    body = body_of(server, K=0.013)
    post(server, body)
    for more in (
        {"modelunits": "Feet"},
        {"absolutetolerance": 0.5},
        {"pointer": "cgc/flow"},
        {"values": body_of(server, K=0.0131)["values"]},
    ):
        assert post(server, {**body, **more})[1] is False
    assert post(server, body)[1] is True


def test_failures_and_what_changes_by_itself_are_not_kept(server):
    wrong = body_of(server, K=5.0)
    assert [post(server, wrong)[:2] for _ in range(2)] == [(422, False), (422, False)]
    submit = body_of(server, "submit", K=[0.01])
    jobs = set()
    for _ in range(2):
        status, kept, content = post(server, submit)
        jobs.add(json.loads(content)["values"][0]["InnerTree"]["{0}"][0]["data"])
        assert (status, kept) == (200, False)
    assert len(jobs) == 2
    fetch = {"pointer": "cgc/fetch", "cachesolve": True, "values": [{"ParamName": "Job", "InnerTree": {"0": [{"data": jobs.pop()}]}}]}
    assert not any(post(server, fetch)[1] for _ in range(3))


def test_the_key_is_checked_before_an_answer_is_looked_up(server):
    body = body_of(server, K=0.01)
    assert post(server, body)[0] == 200 and post(server, body)[1] is True
    assert server.ask("POST", "/solve", json.dumps(body).encode(), RhinoComputeKey=None)[0] == 401


def test_the_answers_not_asked_for_the_longest_make_room():
    answers = Answers(10)
    for name in (b"a", b"b", b"c"):
        answers.put(name, 3 * name)
    assert answers.get(b"a") == b"aaa"
    answers.put(b"d", b"ddd")
    assert [answers.get(name) for name in (b"a", b"b", b"c", b"d")] == [b"aaa", None, b"ccc", b"ddd"]
    answers.put(b"d", b"dddd")
    assert answers.size == 10
    answers.put(b"e", 11 * b"e")
    assert answers.get(b"e") is None and answers.get(b"d") == b"dddd" and answers.size == 10


def test_the_digest_does_not_hang_on_the_order_of_keys():
    one, other = [{"ParamName": "K", "InnerTree": {}}], [{"InnerTree": {}, "ParamName": "K"}]
    assert request_digest("anna", "cgc/dome", one, {}) == request_digest("anna", "cgc/dome", other, {})
    assert request_digest("anna", "cgc/dome", one, {}) != request_digest("anna", "cgc/flow", one, {})
    assert request_digest("anna", "cgc/dome", one, {}) != request_digest("ben", "cgc/dome", one, {})
    assert request_digest("anna", "cgc/dome", one, {"modelunits": "a"}) != request_digest("anna", "cgc/dome", one, {"modelunits": "b"})
