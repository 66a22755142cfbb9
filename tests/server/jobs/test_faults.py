"""What goes wrong with a server in use: clients that hang up, too much at once, and a worker that is killed."""

from __future__ import annotations

import http.client
import json
import os
import signal
import socket
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache

import numpy as np
import pytest

from compas_cgc.io.rhino.meshes import mesh_from_arrays

from ...support.hops_client import Hops
from ...support.server_process import KILLABLE
from ...support.server_process import PATIENCE
from ...support.server_process import running_server
from ...support.server_process import wait_for
from ...support.server_process import worker_of
from ...support.shapes import grid

KEY = "a-key-for-faults"


def hops_body(name, n=6, K=0.01, **inputs):
    """Return the body of a request of Hops that is not answered from what was kept."""
    data = {"Mesh": mesh_from_arrays(*grid(n, 9.0)).Encode(), "K": K, **inputs}
    values = [{"ParamName": own, "InnerTree": {"{0}": [{"data": value}]}} for own, value in data.items()]
    return json.dumps({"pointer": f"cgc/{name}", "values": values}).encode()


@lru_cache
def endless_hops():
    """Return a request that takes longer than anybody waits for it here: many slow steps."""
    return hops_body("flow", 90, Steps=10000)


def job(n=6, **more):
    vertices, faces = grid(n)
    return {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 0.5, **more}


def endless(**more):
    return job(20, method="flow", settings={"steps": 100000, "tolerance": 0.0}, **more)


def submit(server, value):
    status, _, content = server.ask("POST", "/api/v1/jobs", json.dumps(value).encode())
    return status, json.loads(content)


class Hanging:
    """A request whose answer nobody waits for."""

    def __init__(self, server, body, path="/solve", method="POST"):
        host, port = server.address.split(":")
        self.socket = socket.create_connection((host, int(port)), PATIENCE)
        head = f"{method} {path} HTTP/1.1\r\nHost: {server.address}\r\nRhinoComputeKey: {server.key}\r\nContent-Length: {len(body)}\r\n\r\n"
        self.socket.sendall(head.encode() + body)

    def hang_up(self):
        self.socket.close()


# ----------------------------------------------------------------------
# Clients that hang up, and solves that take too long
# ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def one_worker(tmp_path_factory):
    """A server with one worker: whoever does not let go of it keeps all others waiting."""
    # With this grace no worker is ended by force that would end by itself.
    limits = {"grace": PATIENCE, "reserved": 0}
    with running_server(tmp_path_factory.mktemp("one") / "jobs.sqlite", KEY, workers=1, limits=limits) as running:
        yield running


def test_a_client_that_hangs_up_frees_the_worker_for_the_next(one_worker):
    health = one_worker.client.health
    workers = health()["replaced"]
    request = Hanging(one_worker, endless_hops())
    wait_for(lambda: health()["busy"] == 1)
    # It is at its steps by now, and would be for many minutes.
    time.sleep(1.0)
    assert health()["busy"] == 1
    request.hang_up()
    assert one_worker.ask("POST", "/solve", hops_body("dome"))[0] == 200
    assert health() == {**health(), "busy": 0, "idle": 1, "waiting": 0, "replaced": workers}, "stopped without force"


def test_a_call_that_the_end_of_the_server_breaks_off_may_be_tried_again(tmp_path):
    with ThreadPoolExecutor(1) as others:
        with running_server(tmp_path / "jobs.sqlite", workers=1) as server:
            answer = others.submit(server.ask, "POST", "/solve", endless_hops())
            wait_for(lambda: server.client.health()["busy"] == 1)
        status, _, content = answer.result(PATIENCE)
    assert status == 503 and "try again after it has restarted" in json.loads(content)["message"]


def test_a_client_that_hangs_up_while_it_waits_its_turn_is_not_served(one_worker):
    health = one_worker.client.health
    first, second = Hanging(one_worker, endless_hops()), None
    wait_for(lambda: health()["busy"] == 1)
    second = Hanging(one_worker, endless_hops())
    wait_for(lambda: health()["waiting"] == 1)
    second.hang_up()
    first.hang_up()
    assert one_worker.ask("POST", "/solve", hops_body("dome"))[0] == 200


def test_many_that_hang_up_leave_nothing_behind(one_worker):
    health = one_worker.client.health
    for _ in range(2):
        requests = [Hanging(one_worker, endless_hops()) for _ in range(8)]
        wait_for(lambda: health()["waiting"] == 7)
        for request in requests:
            request.hang_up()
        wait_for(lambda: (health()["busy"], health()["waiting"]) == (0, 0), what="solves of clients that are gone")


def test_jobs_keep_nobody_waiting_who_waits_for_an_answer(open_server):
    client = open_server.client
    ids = [submit(open_server, endless())[1]["id"] for _ in range(3)]
    wait_for(lambda: (client.health()["busy"], client.health()["waiting"]) == (1, 2))
    for k in range(10):
        assert open_server.ask("POST", "/solve", hops_body("dome", K=0.01 + 0.001 * k))[0] == 200
    assert [client.poll(id)["state"] for id in ids] == ["running", "queued", "queued"]
    for id in ids:
        client.delete(id)


def test_half_a_request_holds_no_worker(one_worker):
    body = hops_body("dome")
    half = Hanging(one_worker, b"", "/health", "GET")
    for cut in (0, 1, len(body) // 2):
        with socket.create_connection(one_worker.address.split(":"), PATIENCE) as connection:
            connection.sendall(
                f"POST /solve HTTP/1.1\r\nHost: {one_worker.address}\r\nContent-Length: {len(body)}\r\n\r\n".encode() + body[:cut]
            )
        assert one_worker.ask("POST", "/solve", body)[0] == 200
    half.hang_up()


# ----------------------------------------------------------------------
# Limits
# ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def tight(tmp_path_factory):
    """A server that takes little."""
    limits = {"blocking": 3.0, "queue": 5, "per_client": 3, "body": 2**20, "depth": 12, "calls": 2, "reserved": 0}
    with running_server(tmp_path_factory.mktemp("tight") / "jobs.sqlite", KEY, workers=1, limits=limits) as running:
        yield running


@pytest.fixture
def tidy(tight):
    yield tight
    for status in tight.client.jobs():
        tight.client.delete(status["id"])
    wait_for(lambda: (tight.client.health()["busy"], tight.client.health()["waiting"]) == (0, 0))


def test_a_solve_that_takes_too_long_is_stopped_and_the_sentence_says_what_to_do(tidy):
    component = Hops(f"{tidy.url}/cgc/flow", key=KEY)
    started = time.monotonic()
    told = ["the calculation was stopped after 3 s; use /cgc/submit and /cgc/fetch for long solves"]

    def stopped():
        status, outputs, errors, _ = component.post(endless_hops())
        assert status == 504 and outputs == {}
        return errors == told

    # On a busy machine its turn may not come within its time, of which another sentence tells.
    wait_for(stopped)
    assert time.monotonic() - started >= 3.0
    wait_for(lambda: tidy.ask("POST", "/solve", hops_body("dome"))[0] == 200)


def test_a_call_for_which_no_worker_is_free_in_time_is_refused(tidy):
    assert submit(tidy, endless())[0] == 202
    wait_for(lambda: tidy.client.health()["busy"] == 1)
    status, _, content = tidy.ask("POST", "/solve", hops_body("dome"))
    assert status == 504 and "all workers were busy for 3 s" in json.loads(content)["errors"][0]


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have only one address of their own")
def test_the_queue_is_bounded_for_one_and_for_all(tidy):
    def from_address(address, path, body):
        connection = http.client.HTTPConnection(tidy.address, timeout=PATIENCE, source_address=(address, 0))
        connection.request("POST", path, body, {"RhinoComputeKey": KEY})
        answer = connection.getresponse()
        found = answer.status, answer.headers["Retry-After"], json.loads(answer.read())
        connection.close()
        return found

    body = json.dumps(endless()).encode()
    assert [from_address("127.0.0.1", "/api/v1/jobs", body)[0] for _ in range(3)] == [202, 202, 202]
    status, again, found = from_address("127.0.0.1", "/api/v1/jobs", body)
    assert status == 429 and 1 <= int(again) <= 60 and "this client has 3 unfinished jobs" in found["message"]
    status, _, found = from_address("127.0.0.1", "/solve", hops_body("submit"))
    assert status == 429 and found["errors"] == [found["message"]] and found["values"] == []
    assert [from_address("127.0.0.2", "/api/v1/jobs", body)[0] for _ in range(2)] == [202, 202]
    for path, content in (("/api/v1/jobs", body), ("/solve", hops_body("submit"))):
        status, _, found = from_address("127.0.0.3", path, content)
        assert status == 429 and "the queue is full (5 jobs)" in found["errors"][0]


@pytest.mark.nightly
def test_open_jobs_shut_out_no_hops_call_and_clients_behind_a_proxy_are_apart(tmp_path):
    limits, keys = {"per_client": 2, "queue": 6}, ("the-first-key", "the-second-key")

    job_body = json.dumps(endless()).encode()

    def answered(server, path="/api/v1/jobs", body=job_body, **headers):
        return server.ask("POST", path, body, **headers)[0]

    with running_server(tmp_path / "proxy.sqlite", keys[0], workers=1, limits=limits, trusted_proxy="127.0.0.1") as server:
        # The proxy adds an address behind what the client itself may have sent.
        for client in ("192.0.2.1", "192.0.2.2", "192.0.2.99, 192.0.2.3"):
            sent = {"X-Forwarded-For": client}
            assert [answered(server, **sent) for _ in range(3)] == [202, 202, 429]
        assert answered(server, **{"X-Forwarded-For": "192.0.2.4"}) == 429, "the queue is full"
        for k, client in enumerate(("192.0.2.1", "192.0.2.4")):
            assert answered(server, "/solve", hops_body("dome", K=0.01 + 0.001 * k), **{"X-Forwarded-For": client}) == 200
    with running_server(tmp_path / "keys.sqlite", keys, workers=1, limits=limits) as server:
        for key in keys:
            sent = {"RhinoComputeKey": key, "X-Forwarded-For": "192.0.2.1"}
            assert [answered(server, **sent) for _ in range(3)] == [202, 202, 429], "without a trusted proxy all have one address"
        assert answered(server, RhinoComputeKey="another-key") == 401


def test_solves_that_are_waited_for_are_bounded_too(tidy):
    def refused():
        # A call is stopped after 3 s, which on a busy machine may be before the third one comes.
        waiting = [Hanging(tidy, endless_hops()) for _ in range(2)]
        status, _, content = tidy.ask("POST", "/solve", hops_body("dome"))
        for request in waiting:
            request.hang_up()
        return status == 429 and json.loads(content)["message"]

    assert "busy with other solves" in wait_for(refused)


@pytest.mark.parametrize("times", [1.01, 1.9, 3.0, 10.0])
@pytest.mark.parametrize("path", ["/solve", "/api/v1/jobs", "/api/v1/jobs?kind=3dm"])
def test_a_body_over_the_limit_is_refused_with_a_sentence(tidy, path, times):
    status, headers, content = tidy.ask("POST", path, b" " * int(times * 2**20))
    assert (status, headers["Content-Type"]) == (413, "application/json")
    assert "use a coarser mesh" in json.loads(content)["errors"][0]
    assert tidy.client.health()["status"] == "ok"


def test_a_body_without_length_is_read_up_to_the_limit(tidy):
    def pieces(content, size=5000):
        return (content[i : i + size] for i in range(0, len(content), size))

    assert tidy.ask("POST", "/solve", pieces(hops_body("dome")))[0] == 200
    status, _, content = tidy.ask("POST", "/solve", pieces(b" " * int(1.5 * 2**20)))
    assert status == 413 and "coarser" in json.loads(content)["message"]


def test_json_nested_too_deeply_is_refused(tidy):
    for body in (13 * b"[" + 13 * b"]", 100_000 * b'{"a":', 200_000 * b"[", b'{"values":' + 14 * b"[" + 14 * b"]" + b"}"):
        for path in ("/solve", "/api/v1/jobs", "/io"):
            status, _, content = tidy.ask("POST", path, body)
            # Much of it is no name of a function.
            assert status == 400 or (path == "/io" and len(body) > 10**5 and status == 413)
            assert json.loads(content)["errors"]


def test_a_mesh_over_the_limit_is_refused_before_it_is_decoded(one_worker):
    import base64

    encoded = mesh_from_arrays(*grid(6, 9.0)).Encode()
    content = bytearray(base64.b64decode(encoded["data"]))
    # The numbers of vertices and faces, as the archive has them.
    assert np.frombuffer(content[57:65], "<i4").tolist() == [49, 72]
    for counts in ((200_001, 72), (49, 400_001), (2**31 - 1, 2**31 - 1), (-1, 72)):
        content[57:65] = np.array(counts, "<i4").tobytes()
        data = {**encoded, "data": base64.b64encode(content).decode()}
        status, _, answer = one_worker.ask("POST", "/solve", hops_body("dome", Mesh=data))
        assert status == 413 and f"{counts[0]} vertices and {counts[1]} faces" in json.loads(answer)["errors"][0]


def test_event_streams_are_bounded_and_given_back(one_worker):
    id = submit(one_worker, endless())[1]["id"]
    path = f"/api/v1/jobs/{id}/events"
    for _ in range(20):
        assert one_worker.ask("HEAD", path)[0] in (200, 405)
    streams = [Hanging(one_worker, b"", path, "GET") for _ in range(16)]
    for stream in streams:
        assert stream.socket.recv(15).startswith(b"HTTP/1.1 200")
    status, _, content = one_worker.ask("GET", path)
    assert status == 429 and json.loads(content)["errors"]
    assert one_worker.client.health()["status"] == "ok", "others are served meanwhile"
    streams.pop().hang_up()

    def again():
        stream = Hanging(one_worker, b"", path, "GET")
        answered = stream.socket.recv(15).startswith(b"HTTP/1.1 200")
        stream.hang_up()
        return answered

    wait_for(again, what="the place of a stream that was closed")
    one_worker.client.cancel(id)
    for stream in streams:
        stream.hang_up()
    one_worker.client.delete(id)


@pytest.mark.nightly
def test_the_time_of_a_job_is_bounded(tmp_path):
    with running_server(tmp_path / "jobs.sqlite", workers=1, limits={"seconds": 0.5}) as server:
        id = submit(server, endless())[1]["id"]
        wait_for(lambda: server.client.poll(id)["state"] == "failed")
        assert "exceeded the time limit of 0.5 s" in server.client.poll(id)["message"]


# ----------------------------------------------------------------------
# A worker that is killed, and what is no HTTP
# ----------------------------------------------------------------------


@KILLABLE
def test_a_worker_killed_under_a_hops_component_is_told_to_it(one_worker):
    import threading

    component, told = Hops(f"{one_worker.url}/cgc/flow", key=KEY), []
    caller = threading.Thread(target=lambda: told.append(component.post(endless_hops())))
    caller.start()
    wait_for(lambda: one_worker.client.health()["busy"] == 1)
    worker = worker_of(one_worker)
    os.kill(worker, signal.SIGKILL)
    caller.join(PATIENCE)
    status, outputs, errors, _ = told[0]
    assert status == 500 and outputs == {} and "killed by signal 9" in errors[0]
    wait_for(lambda: one_worker.client.health()["idle"] == 1)
    assert one_worker.ask("POST", "/solve", hops_body("dome"))[0] == 200


@pytest.mark.nightly
def test_connections_that_drip_heads_or_send_nothing_stop_nobody(tmp_path):
    opened = []

    def drip(server, count, text):
        for _ in range(count):
            opened.append(socket.create_connection(server.address.split(":"), PATIENCE))
            opened[-1].sendall(text)

    def open_still():
        count = 0
        for line in opened:
            try:
                line.sendall(b"x")
                count += 1
            except OSError:
                continue
        return count

    limits = {"head_seconds": 600.0, "connections": 50}
    try:
        with running_server(tmp_path / "many.sqlite", KEY, workers=1, limits=limits) as server:
            for text in (b"GET /health HTTP/1.1\r\nX-Slow: ", b""):
                drip(server, 300, text)
                for _ in range(5):
                    assert server.ask("GET", "/health", timeout=20.0)[0] == 200
            wait_for(lambda: open_still() <= 50)
            # An answer that somebody waits for makes room for nobody.
            id = submit(server, endless())[1]["id"]
            stream = Hanging(server, b"", f"/api/v1/jobs/{id}/events", "GET")
            assert stream.socket.recv(15).startswith(b"HTTP/1.1 200")
            drip(server, 60, b"GET ")
            assert server.client.health()["busy"] == 1 and stream.socket.recv(100)
            server.client.delete(id)
        with running_server(tmp_path / "slow.sqlite", KEY, workers=1, limits={"head_seconds": 1.0}) as server:
            opened.clear()
            drip(server, 20, b"GET /health HTTP/1.1\r\nX-Slow: ")
            # Each of them goes on with its head all the while.
            wait_for(lambda: not open_still(), seconds=30.0, what="heads without end")
    finally:
        for line in opened:
            line.close()


@pytest.mark.parametrize(
    "head, status",
    [
        (b"GET /health HTTP/1.1\r\nHost: x\r\nno header at all\r\n\r\n", 400),
        (b"POST /solve HTTP/1.1\r\nHost: x\r\nContent-Length: many\r\n\r\n", 400),
        (b"POST /solve HTTP/1.1\r\nHost: x\r\nContent-Length: 1\r\nTransfer-Encoding: wrong\r\n\r\n", 501),
        (b"GET /health HTTP/1.1\r\nHost: x\r\nX: " + b"x" * 400_000 + b"\r\n\r\n", 431),
    ],
)
def test_what_is_no_http_is_answered_in_json(tidy, head, status):
    host, port = tidy.address.split(":")
    with socket.create_connection((host, int(port)), PATIENCE) as line:
        line.sendall(head)
        answer = http.client.HTTPResponse(line)
        answer.begin()
        found = json.loads(answer.read())
    assert answer.status == status and "not valid HTTP" in found["message"] and found["values"] == []
