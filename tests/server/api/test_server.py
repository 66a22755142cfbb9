"""The job API over HTTP, with a real server: what it gives, and whom it refuses."""

from __future__ import annotations

import base64
import gzip
import http.client
import itertools
import json
import os
import re
import signal
import subprocess
import sys
import time

import compas
import numpy as np
import pytest
import rhino3dm

from compas_cgc import CGCMesh
from compas_cgc.client import Client
from compas_cgc.client import Refused
from compas_cgc.server import Limits
from compas_cgc.server.api.openapi import description

from ...support.rhino_models import Sketch
from ...support.rhino_models import dots_of
from ...support.rhino_models import result_of
from ...support.server_process import KEY
from ...support.server_process import PATIENCE
from ...support.server_process import running_server
from ...support.server_process import wait_for
from ...support.shapes import grid


def ask(server, method, path, body=None, key=KEY, **headers):
    """Return status, headers and body of one raw request."""
    return server.ask(method, path, body, **{"RhinoComputeKey": key, **headers})


def request(n=6, **more):
    vertices, faces = grid(n)
    return {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 0.5, **more}


def endless(**more):
    return request(20, method="flow", settings={"steps": 100000, "tolerance": 0.0}, **more)


def post(server, value):
    body = value if isinstance(value, bytes) else json.dumps(value).encode()
    return ask(server, "POST", "/api/v1/jobs", body)


def finished(server, id):
    wait_for(lambda: server.client.poll(id)["state"] in ("succeeded", "failed", "cancelled"), what="the job does not end")
    return server.client.poll(id)


def test_the_moulds_of_a_result(server, tmp_path):
    settings = {"measure": "exact"}
    job = json.loads(post(server, request(8, targets=0.3, method="newton", settings=settings))[2])["id"]
    path = f"/api/v1/jobs/{job}/moulds"
    assert finished(server, job)["state"] == "succeeded"
    status, _, content = ask(server, "GET", f"{path}?count=4&material=timber&thickness=12")
    told = json.loads(content)
    assert status == 200 and len(told["panels"]) == 4 and told["moulds"][0]["kind"] == "sphere" and "12 mm of timber" in told["text"]
    assert all(panel["edge_error"] < 1e-11 for panel in told["panels"])
    assert server.client.moulds(job, count=4, material="timber", thickness=12, rough=True)["panels"] == told["panels"]
    assert server.client.moulds_file(job, count=4).startswith(b"3D Geometry File Format ")
    status, headers, content = ask(server, "GET", f"{path}?size=0.5&format=3dm")
    assert status == 200 and "moulds.3dm" in headers["Content-Disposition"]
    (tmp_path / "moulds.3dm").write_bytes(content)
    assert "mould 1" in dots_of(tmp_path / "moulds.3dm")
    for query, sentence in (
        ("count=4&material=cheese", "there is no material 'cheese'"),
        ("count=x", "'count' must be a whole number"),
        ("size=1e-9", "cannot be divided"),
        ("colour=red", "there is no option 'colour'"),
        ("format=dwg", "'format' must be one of json, 3dm"),
        ("rough=maybe", "'rough' must be true or false"),
        ("along=laths", "along must be one of"),
    ):
        status, _, content = ask(server, "GET", f"{path}?{query}")
        assert status == 422 and sentence in json.loads(content)["message"], query
    assert ask(server, "GET", "/api/v1/jobs/nowhere-to-be-found/moulds")[0] == 404


def test_a_job_from_hand_in_to_every_format(server, tmp_path):
    status, headers, content = post(server, request(name="roof"))
    job = json.loads(content)
    assert status == 202 and headers["Location"] == job["status_url"] and "check;dur=" in headers["Server-Timing"]
    done = finished(server, job["id"])
    assert (done["state"], done["progress"], done["name"]) == ("succeeded", 1.0, "roof")
    arrays = server.client.result(job["id"])
    assert arrays["status"] == "converged" and arrays["max_error"] < 1e-6 and len(arrays["report"]["regions"]) == 1
    assert np.allclose([K for K in arrays["curvature"] if K is not None], 0.5)
    errors = [abs(K - target) for K, target in zip(arrays["curvature"], arrays["targets"]) if K is not None]
    assert arrays["report"]["max_error"] == max(errors), "the report has the errors of the surface"
    mesh = compas.json_loads(server.client.result(job["id"], "compas").decode())
    assert isinstance(mesh, CGCMesh) and np.array_equal(mesh.arrays()[0], arrays["vertices"])
    from compas_cgc.io import read_mesh

    for kind in ("3dm", "obj"):
        path = tmp_path / f"roof.{kind}"
        path.write_bytes(server.client.result(job["id"], kind))
        assert np.allclose(sorted(map(tuple, read_mesh(path)[0].arrays()[0])), sorted(map(tuple, arrays["vertices"])))


def test_a_compas_mesh_and_files_are_taken(server, tmp_path):
    mesh = CGCMesh.from_meshgrid(dx=4, nx=6)
    mesh.set_supports("corners")
    mesh.set_creases([[7 * i + 3 for i in range(7)]])
    mesh.set_target(0.01)
    same = {"mesh": json.loads(compas.json_dumps(mesh))}
    from compas_cgc.io import write

    write(tmp_path / "roof.3dm", mesh)
    jobs = [json.loads(post(server, same)[2])["id"], server.client.submit_file((tmp_path / "roof.3dm").read_bytes(), "3dm")]
    for id in jobs:
        assert finished(server, id)["state"] == "succeeded"
    first, second = (server.client.result(id) for id in jobs)
    assert first["creases"] and first["roles"].count("fixed") == 4 == second["roles"].count("fixed")
    assert np.allclose(np.ptp(first["vertices"], axis=0), np.ptp(second["vertices"], axis=0))


def test_outlines_and_surfaces_of_files_are_meshed_with_an_edge_length(server, tmp_path):
    sketch = Sketch()
    sketch.curve(np.array([[0, 0, 0], [6, 0, 0], [6, 4, 0], [0, 4, 0], [0, 0, 0]], float))
    content = sketch.save(tmp_path / "outline.3dm").read_bytes()
    id = server.client.submit_file(content, "3dm", edge_length=1.0, supports="corners", targets=0.01)
    assert finished(server, id)["state"] == "succeeded"
    found = server.client.result(id)
    assert 30 < len(found["vertices"]) < 60 and np.allclose(np.ptp(found["vertices"], axis=0)[:2], [6, 4])
    assert found["roles"].count("fixed") == 4 and max(row[2] for row in found["vertices"]) > 0.1
    for length, part in ((0, "greater than zero"), ("fine", "must be a number")):
        with pytest.raises(Refused, match=part):
            server.client.submit_file(content, "3dm", edge_length=length)
    far_too_fine = finished(server, server.client.submit_file(content, "3dm", edge_length=1e-7, supports="corners", targets=0.01))
    assert far_too_fine["state"] == "failed" and "use a longer edge" in far_too_fine["message"]


def test_packed_arrays_are_lists_in_fewer_bytes(server):
    vertices, faces = grid(6)
    server.client.submit(vertices, faces, supports="boundary", targets=0.5, id="packed-0001")
    plain = server.client.result(finished(server, "packed-0001")["id"])
    _, _, answer = post(server, request(id="packed-0002"))
    id = finished(server, json.loads(answer)["id"])["id"]
    _, _, content = ask(server, "GET", f"/api/v1/jobs/{id}/result?format=arrays")
    _, _, packed = ask(server, "GET", f"/api/v1/jobs/{id}/result?format=packed")
    lists = json.loads(content)
    for name in ("vertices", "faces", "curvature", "targets", "roles", "creases"):
        assert plain[name] == lists[name], name
    assert len(packed) < len(content)


@pytest.mark.parametrize(
    "more, part",
    [
        ({"base64": "!", "type": "f8", "shape": [1, 3]}, "not valid base64"),
        ({"base64": "", "type": "f4", "shape": [0, 3]}, "as a packed array must be"),
        ({"base64": "AAAA", "type": "f8", "shape": [1, 3]}, "do not match its shape"),
        ({"base64": "", "type": "f8", "shape": [-1, 3]}, "as a packed array must be"),
        ({"base64": "", "type": "f8", "shape": [0, 3]}, "at least three"),
        ({"base64": base64.b64encode(np.full(9, np.nan).tobytes()).decode(), "type": "f8", "shape": [3, 3]}, "is not finite"),
        ({"base64": base64.b64encode(np.zeros(6)).decode(), "type": "f8", "shape": [3, 2]}, "three numbers each"),
    ],
)
def test_packed_arrays_are_read_with_suspicion(server, more, part):
    status, _, answer = post(server, {**request(), "vertices": more})
    assert status == 422 and part in json.loads(answer)["message"]


def test_constraints_arrive(server, tmp_path):
    vertices, faces = grid(8, 8.0)
    middle = 40
    raised = [{"kind": "height", "vertices": [middle], "height": 1.5}]
    result = server.client.solve(vertices, faces, supports="corners", targets=0.01, goals=raised)
    assert result["status"] == "converged" and result["vertices"][middle][2] == pytest.approx(1.5, abs=1e-9)
    for constraints, part in (
        ([{"kind": "height", "vertices": [99], "height": 1.0}], "vertex 99"),
        ([{"kind": "magnet"}], "plane, height"),
        ({"kind": "held"}, "list of objects"),
    ):
        with pytest.raises(Refused, match=part):
            server.client.submit(vertices, faces, supports="boundary", targets=0.01, goals=constraints)
    with pytest.raises(Refused, match="only the method projection"):
        server.client.submit(vertices, faces, supports="boundary", targets=0.01, goals=raised, method="newton")


def test_degenerate_faces_are_named_before_anything_is_queued(server):
    value = request()
    value["faces"] += [[0, 1, 1]]
    status, _, answer = post(server, value)
    assert status == 422 and "faces 72 of the input are degenerate" in json.loads(answer)["message"]


def test_a_status_can_wait_for_the_end_of_the_job(server):
    id = server.client.submit(*grid(12), supports="boundary", targets=0.5)
    wait_for(lambda: server.client.poll(id, wait=20)["state"] == "succeeded")
    id = json.loads(post(server, endless())[2])["id"]
    started = time.monotonic()
    assert server.client.poll(id, wait=0.5)["state"] in ("queued", "running") and time.monotonic() - started >= 0.5
    assert ask(server, "GET", f"/api/v1/jobs/{id}?wait=nan")[0] == ask(server, "GET", f"/api/v1/jobs/{id}?wait=-1")[0] == 200
    server.client.delete(id)


def test_a_result_goes_into_the_file_of_the_architect(server, tmp_path):
    mesh = CGCMesh.from_meshgrid(dx=6, nx=6)
    mesh.set_supports("boundary")
    mesh.set_target(0.02)
    mesh.to_3dm(tmp_path / "roof.3dm")
    drawn = rhino3dm.File3dm.Read(str(tmp_path / "roof.3dm"))
    drawn.Objects.AddTextDot("column by the neighbour", rhino3dm.Point3d(1, 2, 3))
    drawn.Write(str(tmp_path / "roof.3dm"), 7)
    content = (tmp_path / "roof.3dm").read_bytes()
    id = finished(server, server.client.submit_file(content, "3dm"))["id"]
    (tmp_path / "solved.3dm").write_bytes(server.client.result(id, "3dm", beside=content))
    vertices, _, record = result_of(tmp_path / "solved.3dm")
    assert np.array_equal(vertices, server.client.result(id)["vertices"]) and record["status"] == "converged"
    assert "column by the neighbour" in dots_of(tmp_path / "solved.3dm")
    for bad, status, part in ((b"not a file", 422, "3dm"), (b"", 400, "empty")):
        with pytest.raises(Refused, match=part) as refusal:
            server.client.result(id, "3dm", beside=bad)
        assert refusal.value.status == status and str(tmp_path) not in str(refusal.value) and "tmp" not in str(refusal.value)
    with pytest.raises(Refused, match="must be 3dm"):
        server.client.result(id, "obj", beside=content)


def test_damaged_files_fail_with_a_sentence_and_without_a_path(server):
    for kind in ("3dm", "obj"):
        status = finished(server, server.client.submit_file(b"not a file at all", kind))
        assert status["state"] == "failed" and "upload" not in status["message"] and os.sep + "tmp" not in status["message"]


def test_the_same_id_is_the_same_job(server):
    first, again = (json.loads(post(server, request(id="my-roof-1"))[2])["id"] for _ in range(2))
    assert first == again == "my-roof-1"
    assert post(server, request(8, id="my-roof-1"))[0] == 409


def test_events_arrive_while_it_solves_and_cancel_is_quick(server):
    id = json.loads(post(server, endless(live=True))[2])["id"]
    connection = http.client.HTTPConnection(server.url.split("//")[1], timeout=PATIENCE)
    connection.request("GET", f"/api/v1/jobs/{id}/events", headers={"Authorization": f"Bearer {KEY}"})
    stream = connection.getresponse()
    assert stream.getheader("Content-Type").startswith("text/event-stream")
    seen = []
    for line in stream:
        if line.startswith(b"data: "):
            seen.append(json.loads(line[6:]))
            if sum(status["iteration"] > 0 for status in seen) == 2 and seen[-1]["state"] == "running":
                status, _, surface = ask(server, "GET", f"/api/v1/jobs/{id}/surface")
                assert status == 200 and len(surface) == 12 * 21**2
                assert ask(server, "GET", f"/api/v1/jobs/{id}/result")[0] == 409
                assert ask(server, "POST", f"/api/v1/jobs/{id}/cancel")[0] == 200
        if seen and seen[-1]["state"] == "cancelled":
            break
    steps = [status["iteration"] for status in seen]
    assert steps == sorted(steps) and steps[-1] > 0 and seen[-1]["message"].startswith("cancelled after")
    connection.close()
    assert ask(server, "DELETE", f"/api/v1/jobs/{id}")[0] == 204
    assert ask(server, "GET", f"/api/v1/jobs/{id}")[0] == 404


def test_one_request_solves_and_brings_the_surface(server):
    """The stream of a job that is followed ends with what its client lacks, the same bits as by the other way."""
    body = json.dumps(request(id="followed-1")).encode()
    status, headers, content = ask(server, "POST", "/api/v1/jobs?follow=true", body)
    assert status == 200 and headers["Content-Type"].startswith("text/event-stream")
    blocks = [dict(line.split(b": ", 1) for line in block.split(b"\n")) for block in content.split(b"\n\n") if block.startswith(b"event")]
    assert [block[b"event"] for block in blocks][-2:] == [b"done", b"result"]
    found = json.loads(blocks[-1][b"data"])
    asked = json.loads(ask(server, "GET", "/api/v1/jobs/followed-1/result?format=packed")[2])
    assert {name: value for name, value in asked.items() if name not in ("faces", "roles", "creases")} == found
    assert ask(server, "POST", "/api/v1/jobs?follow=oops", body)[0] == 422


def test_who_watches_sees_the_surface_and_then_the_words_before_all_is_measured(server):
    every = [b"surface", b"verdict", b"done", b"result"]
    seen: list[bytes] = []
    end = time.monotonic() + PATIENCE
    for attempt in itertools.count():
        assert time.monotonic() < end
        body = json.dumps(request(id=f"watched-{attempt}", live=True)).encode()
        content = ask(server, "POST", "/api/v1/jobs?follow=true", body)[2]
        blocks = [
            dict(line.split(b": ", 1) for line in block.split(b"\n")) for block in content.split(b"\n\n") if block.startswith(b"event")
        ]
        told = {block[b"event"]: json.loads(block[b"data"]) for block in blocks if block[b"event"] != b"progress"}
        seen = list(told)
        # A stream that wakes late, on a busy machine, tells the end alone.
        assert seen == [kind for kind in every if kind in told] and seen[-2:] == every[-2:]
        if seen == every:
            break
    found, said = told[b"result"], told[b"verdict"]
    assert told[b"surface"]["vertices"] == found["vertices"]
    assert {name: said[name] for name in ("status", "message", "ending")} == {name: found[name] for name in ("status", "message", "ending")}
    assert (said["fair"], said["reasons"]) == (found["report"]["verdict"]["fair"], found["report"]["verdict"]["reasons"])


def test_health_answers_while_all_workers_are_busy(server):
    ids = [json.loads(post(server, endless())[2])["id"] for _ in range(3)]
    wait_for(lambda: server.client.health()["busy"] == 2)
    health = server.client.health()
    assert health["status"] == "ok" and (health["busy"], health["waiting"]) == (2, 1)
    for id in ids:
        server.client.cancel(id)
        assert finished(server, id)["state"] == "cancelled"


def test_nothing_is_computed_without_the_key(server):
    body = json.dumps(request()).encode()
    for key in (None, "wrong", "ä"):
        given = {"RhinoComputeKey": key.encode().decode("latin-1")} if key else {}
        status, headers, content = ask(server, "POST", "/api/v1/jobs", body, None, **given)
        assert status == 401 and "key is missing or wrong" in json.loads(content)["errors"][0]
    assert ask(server, "POST", "/api/v1/jobs", body, None, Authorization=f"Bearer {KEY}")[0] == 202
    assert ask(server, "GET", "/api/v1/jobs", key=None)[0] == 401
    # Malformed as it is, nobody looks into it.
    assert ask(server, "POST", "/solve", b"{", None)[0] == 401
    for path in ("/health", "/version", "/openapi.json", "/", "/cgc/dome"):
        assert ask(server, "GET", path, key=None)[0] == 200


def test_other_hosts_and_other_pages_are_refused(server):
    host = server.url.split("//")[1]
    assert ask(server, "GET", "/health", Host="evil.example:80")[0] == 421
    assert ask(server, "GET", "/health", Host="[broken")[0] in (400, 421)
    for origin in ("https://evil.example", "null", "http://127.0.0.1:1"):
        assert ask(server, "POST", "/solve", b"{}", Origin=origin)[0] == 403
    status, headers, _ = ask(server, "GET", "/health", Origin=f"http://{host}")
    assert status == 200 and "Access-Control-Allow-Origin" not in headers
    assert headers["X-Content-Type-Options"] == "nosniff" and "default-src 'none'" in headers["Content-Security-Policy"]


BAD = {
    "not valid JSON": (b"{", 400, "not valid JSON"),
    "not a text file": (b"\xff\xfe\x00", 400, "UTF-8"),
    "nothing": (b"", 400, "not valid JSON"),
    "NaN": (b'{"vertices": [[NaN, 0, 0]]}', 400, "NaN"),
    "a nest": (b'{"settings": ' + 40 * b"[" + 40 * b"]" + b"}", 400, "nested more than 32"),
    "a deep nest": (200_000 * b"[", 400, "JSON"),
    "many digits": (b'{"targets": ' + 5000 * b"1" + b"}", 400, "digits"),
    "a list": (b"[]", 422, "object"),
    "an unknown field": (b'{"vertexes": []}', 422, "unknown field 'vertexes'"),
    "no faces": (b'{"vertices": [[0,0,0],[1,0,0],[0,1,0]]}', 422, "'faces'"),
    "texts": (b'{"vertices": [["0","1","2"]], "faces": [[0,0,0]]}', 422, "three numbers"),
    "ragged": (b'{"vertices": [[0,1],[0,1,2]], "faces": [[0,0,0]]}', 422, "three numbers"),
    "infinite": (b'{"vertices": [[1e999,0,0],[1,0,0],[0,1,0]], "faces": [[0,1,2]]}', 422, "vertex 0"),
    "too far": (b'{"vertices": [[1e300,0,0],[1,0,0],[0,1,0]], "faces": [[0,1,2]]}', 422, "vertex 0"),
    "the vertex does not exist": (b'{"vertices": [[0,0,0],[1,0,0],[0,1,0]], "faces": [[0,1,3]]}', 422, "refers to vertex 3"),
    "half a vertex": (b'{"vertices": [[0,0,0],[1,0,0],[0,1,0]], "faces": [[0,1,1.5]]}', 422, "integers only"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_requests_are_refused_with_a_sentence(server, name):
    body, expected, part = BAD[name]
    status, headers, content = post(server, body)
    answer = json.loads(content)
    assert (status, headers["Content-Type"]) == (expected, "application/json")
    assert part in answer["message"] and answer["errors"] == [answer["message"]] and answer["values"] == []


@pytest.mark.parametrize(
    "more, part",
    [
        ({"method": "magic"}, "'method' must be one of"),
        ({"targets": [1.0]}, "1 numbers for 49"),
        ({"targets": {"x": 1.0}}, "region numbers as keys"),
        ({"targets": True}, "must be a number"),
        ({"supports": [99]}, "refers to vertex 99"),
        ({"supports": "everything"}, '"boundary", "outline" or "corners"'),
        ({"creases": [[0, "1"]]}, "integer"),
        ({"settings": {"stepps": 1}}, "no setting 'stepps'"),
        ({"settings": {"tau": 0.5, "nearness": 1.0}}, "do not belong to one method; name it"),
        ({"settings": {"steps": 10**9}}, "at most 100000 steps"),
        ({"settings": {"delay": -1}}, "e must be a whole number from 0 up"),
        ({"settings": []}, "must be an object that maps names of settings"),
        ({"method": "flow", "settings": {"steps": 0}}, "steps must be"),
        ({"method": "flow", "settings": {"steps": 10**9}}, "at most 100000 steps"),
        ({"flip": 1}, "true or false"),
        ({"id": "short"}, "8 to 64"),
        ({"id": 5}, "'id' must be a string"),
        ({"supports": None, "roles": ["fixed"]}, "one role per vertex"),
        ({"mesh": {"dtype": "os/system", "data": {}}}, "COMPAS Mesh"),
    ],
)
def test_wrong_fields_are_named(server, more, part):
    status, _, content = post(server, request(**more))
    assert status == 422 and part in json.loads(content)["message"]


def test_meshes_that_cannot_be_solved_fail_with_the_reason(server):
    one = {"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [[0, 1, 2]], "supports": "boundary", "targets": 1.0}
    for value, part in (
        (one, "no internal vertex"),
        (request(supports=[]), "no support"),
        (request(creases=[[0, 48]]), "does not follow an edge"),
    ):
        status = finished(server, json.loads(post(server, value)[2])["id"])
        assert status["state"] == "failed" and part in status["message"]


def test_what_a_mesh_lacks_is_said_without_calls_of_python(server):
    tetrahedron = {"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "faces": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]}
    two = [[7 * k + 3 for k in range(7)]]
    for value, part in (
        (request(supports=[]), 'fix vertices (supports "boundary" fixes the whole boundary)'),
        ({**tetrahedron, "supports": [], "targets": 1.0}, "so name the vertices: a list of vertices as supports"),
        (request(targets=None), "no target curvature is set; set one, as targets"),
        (request(creases=two, targets={"0": 0.1}), "set one for their region in targets"),
    ):
        status = finished(server, json.loads(post(server, value)[2])["id"])
        assert status["state"] == "failed" and part in status["message"]
        assert not re.search(r"mesh\.|\w\(|--\w", status["message"])


def test_jobs_are_listed_page_by_page_and_know_their_place_in_the_queue(tmp_path):
    with running_server(tmp_path / "jobs.sqlite", KEY, workers=1) as own:

        def listed(query=""):
            status, _, content = ask(own, "GET", f"/api/v1/jobs?{query}")
            return status, json.loads(content)

        ids = [own.client.submit(*grid(4), id=f"finished-{k}", supports="boundary", targets=0.5) for k in range(3)]
        assert [finished(own, id)["position"] for id in ids] == [None, None, None]
        more = {"supports": "boundary", "targets": 0.5, "method": "flow", "settings": {"steps": 100000, "tolerance": 0.0}}
        ids += [own.client.submit(*grid(20), id=f"unfinished-{k}", **more) for k in range(3)]
        wait_for(lambda: own.client.poll(ids[3])["state"] == "running")
        assert [own.client.poll(id)["position"] for id in ids[3:]] == [None, 1, 2]
        _, found = listed()
        assert [job["id"] for job in found["jobs"]] == ids[::-1] and (found["total"], found["limit"], found["offset"]) == (6, 100, 0)
        _, found = listed("limit=2&offset=1")
        assert [job["id"] for job in found["jobs"]] == ids[4:2:-1] and found["total"] == 6
        _, found = listed("state=queued&limit=1")
        assert [(job["id"], job["position"]) for job in found["jobs"]] == [(ids[5], 2)] and found["total"] == 2
        assert listed("state=failed")[1]["jobs"] == []
        for query, part in (
            ("colour=red", "unknown parameter 'colour'; the parameters are limit, offset, state"),
            ("limit=0", "'limit' must be an integer from 1 to 1000"),
            ("limit=many", "'limit' must be"),
            ("offset=-1", "'offset' must be an integer from 0"),
            ("state=lost", "'state' must be one of queued"),
        ):
            status, found = listed(query)
            assert status == 422 and part in found["message"]
        for id in ids[3:]:
            own.client.delete(id)


def test_every_operation_has_a_name_of_its_own():
    operations = [own for path in description()["paths"].values() for name, own in path.items() if name != "parameters"]
    names = [own["operationId"] for own in operations]
    assert len(set(names)) == len(names) == 31 and all(name.isidentifier() for name in names)


def test_too_much_is_refused(server):
    assert post(server, b" " * (Limits().body + 1))[0] == 413
    many = b'{"vertices": [' + b"[0,0,0]," * Limits().vertices + b"[0,0,0]]}"
    status, _, content = post(server, many)
    assert status == 413 and "coarser" in json.loads(content)["message"]


def test_gets_of_pages_of_other_sites_are_refused(server):
    for site in ("cross-site", "same-site"):
        for path in ("/health", "/api/v1/jobs", "/cgc/dome", "/page/main.js", "/"):
            status, _, content = ask(
                server, "GET", path, **{"Sec-Fetch-Site": site, "Sec-Fetch-Mode": "no-cors", "Sec-Fetch-Dest": "script"}
            )
            assert status == 403 and "other sites" in json.loads(content)["message"]
        visit = {"Sec-Fetch-Site": site, "Sec-Fetch-Mode": "navigate", "Sec-Fetch-Dest": "document"}
        assert ask(server, "GET", "/", Accept="text/html", **visit)[0] == 200, "a link to the page may be anywhere"
        assert ask(server, "GET", "/api/v1/jobs", **visit)[0] == 403
    for site in ("same-origin", "none"):
        assert ask(server, "GET", "/api/v1/jobs", **{"Sec-Fetch-Site": site})[0] == 200


def test_other_addresses_answer_in_json_too(server):
    for method, path, expected in (("GET", "/nothing", 404), ("PUT", "/health", 405), ("GET", "/api/v1/jobs/nobody-here", 404)):
        status, headers, content = ask(server, method, path)
        assert status == expected and headers["Content-Type"] == "application/json" and json.loads(content)["errors"]
    assert ask(server, "GET", "/api/v1/jobs/nobody-here/result?format=exe")[0] == 422


def test_a_compressed_body_is_named(server):
    for path in ("/solve", "/api/v1/jobs"):
        status, _, content = ask(server, "POST", path, gzip.compress(b"{}"), **{"Content-Encoding": "gzip"})
        assert status == 415 and "gzip" in json.loads(content)["message"]


def test_the_description_names_what_is_served(server):
    served = json.loads(ask(server, "GET", "/openapi.json")[2])
    assert served == description()
    for path, operations in served["paths"].items():
        for method in set(operations) - {"parameters"}:
            status, _, content = ask(server, method.upper(), path.replace("{id}", "nobody-here"), b"{}" if method == "post" else None)
            assert str(status) in operations[method]["responses"], (method, path, status, content)


def test_random_requests_never_make_the_server_fail(server):
    random = np.random.default_rng(7)
    good = json.dumps(request(2)).encode()
    pieces = [b"null", b"-1", b"1e400", b"[]", b"{}", b'"x"', b"true", b"[[]]", b'"\\ud800"', b"0.5"]
    for _ in range(150):
        at = int(random.integers(len(good)))
        cut = int(random.integers(1, 12))
        piece = pieces[int(random.integers(len(pieces)))]
        for path in ("/api/v1/jobs", "/solve"):
            status, _, content = ask(server, "POST", path, good[:at] + piece + good[at + cut :])
            assert status in (202, 400, 404, 422, 429), content
            assert isinstance(json.loads(content), dict)


@pytest.mark.nightly
def test_jobs_survive_a_kill_of_the_server(tmp_path):
    store = tmp_path / "jobs.sqlite"
    with running_server(store, workers=1) as first:
        done = first.client.solve(*grid(6), supports="boundary", targets=0.5, id="done-before")
        vertices, faces = grid(20)
        first.client.submit(
            vertices, faces, id="was-running", supports="boundary", targets=0.5, method="flow", settings={"steps": 400, "tolerance": 0.0}
        )
        ids = [first.client.submit(*grid(6), id=f"waiting-{k}", supports="boundary", targets=0.3) for k in range(3)]
        first.process.kill()
        first.process.wait(PATIENCE)
    with running_server(store, workers=1) as second:
        assert second.client.result("done-before") == done
        for id in ("was-running", *ids):
            assert finished(second, id)["state"] == "succeeded"
        assert second.client.result("was-running")["iterations"] >= 400


@pytest.mark.nightly
def test_it_stops_quickly_whatever_is_under_way(tmp_path):
    with running_server(tmp_path / "jobs.sqlite") as running:
        id = running.client.submit(*grid(40), **{name: value for name, value in endless().items() if name not in ("vertices", "faces")})
        stream = http.client.HTTPConnection(running.url.split("//")[1], timeout=PATIENCE)
        stream.request("GET", f"/api/v1/jobs/{id}/events")
        assert stream.getresponse().readline().startswith(b"event")
        running.process.send_signal(signal.SIGINT if sys.platform != "win32" else signal.SIGTERM)
        assert running.process.wait(PATIENCE) == 0, "its job would go on for many minutes"
        stream.close()


def test_it_does_not_open_to_a_network_without_a_key():
    command = [sys.executable, "-m", "compas_cgc", "serve", "--host", "0.0.0.0", "--port", "0"]
    bare = {name: value for name, value in os.environ.items() if name != "COMPAS_CGC_KEY"}
    done = subprocess.run(command, capture_output=True, text=True, env=bare, timeout=PATIENCE)
    assert done.returncode == 2 and "requires a key" in done.stderr


def test_a_port_in_use_is_said(server):
    port = server.url.rsplit(":", 1)[1]
    done = subprocess.run([sys.executable, "-m", "compas_cgc", "serve", "--port", port], capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 2 and "a server of compas_cgc" in done.stderr and "--port" in done.stderr


def test_a_wrong_key_is_refused_to_the_client(server):
    with pytest.raises(Refused, match="key is missing or wrong") as refusal:
        Client(server.url, "nonsense", retries=0).jobs()
    assert refusal.value.status == 401


def test_a_pointer_is_never_followed(server):
    for pointer in ("http://127.0.0.1:1/cgc/nothing", "file:///etc/passwd", "../../cgc/dome/x"):
        body = json.dumps({"pointer": pointer, "values": []}).encode()
        assert ask(server, "POST", "/solve", body)[0] == 404
    algo = base64.b64encode(b"import os").decode()
    assert ask(server, "POST", "/grasshopper", json.dumps({"pointer": None, "algo": algo, "values": []}).encode())[0] == 404


def test_half_characters_are_no_text(server):
    for value in (request(name="\ud800"), {"values": "\ud800"}):
        status, _, content = post(server, json.dumps(value).encode())
        assert status == 400 and "half of a surrogate pair" in json.loads(content)["message"]
    status, _, content = post(server, json.dumps(request(name="\u00e9 \U0001f600")).encode())
    assert status == 202 and finished(server, json.loads(content)["id"])["name"] == "\u00e9 \U0001f600"
