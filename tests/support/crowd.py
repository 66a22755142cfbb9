"""How fast a server answers in a crowd: ``python -m tests.support.crowd``.

``/health`` is asked from a process of its own while a client sends 59 MB of unknown keys, while 275 connections drip their
heads and while 400 say nothing; a dome of 121 vertices is asked of Hops while a long job runs on every worker.
"""

from __future__ import annotations

import http.client
import json
import multiprocessing
import socket
import sys
import tempfile
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from .server_process import running_server
from .shapes import grid
from .soak import hops_body

KEY = "key-of-the-crowd"
BODY = b"{" + b",".join(b'"unknown key %08d":"%s"' % (k, b"x" * 26) for k in range(1_000_000)) + b"}"


def delays(address, seconds, answers):
    """Ask ``/health`` twenty times a second and give back how long each answer took."""
    found, end = [], time.monotonic() + seconds
    while time.monotonic() < end:
        started = time.monotonic()
        connection = http.client.HTTPConnection(address, timeout=30.0)
        connection.request("GET", "/health")
        assert connection.getresponse().read()
        connection.close()
        found.append(time.monotonic() - started)
        time.sleep(0.05)
    answers.put(found)


def health_beside(address, doing, seconds=20.0):
    """Return the delays of ``/health`` while a function runs again and again."""
    context = multiprocessing.get_context("spawn")
    answers, over = context.Queue(), threading.Event()
    watcher = context.Process(target=delays, args=(address, seconds, answers))
    crowd = threading.Thread(target=lambda: [doing() for _ in iter(over.is_set, True)])
    crowd.start()
    watcher.start()
    found = answers.get(timeout=seconds + 60.0)
    over.set()
    crowd.join()
    return found


@contextmanager
def connections(address, count, text):
    """Open many connections and send each the beginning of a head."""
    host, port = address.split(":")
    lines = [socket.create_connection((host, int(port)), 30.0) for _ in range(count)]
    try:
        for line in lines:
            line.sendall(text)
        yield lines
    finally:
        for line in lines:
            line.close()


def drip(lines):
    """Send one more byte on each connection that is still open."""
    for line in lines:
        try:
            line.sendall(b"x")
        except OSError:
            continue
    time.sleep(0.2)


def flooded(server):
    """Send the 59 MB and return the status of the answer."""
    try:
        return server.ask("POST", "/api/v1/jobs", BODY)[0]
    except OSError:
        return "connection closed"


def domes(server, count=100):
    """Return how long Hops waits for a dome of 121 vertices while every worker has a long job."""
    vertices, faces = grid(40)
    long = {"vertices": vertices.tolist(), "faces": faces.tolist(), "supports": "boundary", "targets": 0.5, "method": "flow"}
    long["settings"] = {"steps": 100_000, "tolerance": 0.0}
    ids = [json.loads(server.ask("POST", "/api/v1/jobs", json.dumps(long).encode())[2])["id"] for _ in range(4)]
    while not any(server.client.poll(id)["iteration"] for id in ids):
        time.sleep(0.05)
    found = []
    for number in range(count):
        started = time.monotonic()
        assert server.ask("POST", "/solve", hops_body(10, 0.004 + 1e-6 * number))[0] == 200
        found.append(time.monotonic() - started)
    for id in ids:
        server.client.cancel(id)
    return found


def told(what, seconds):
    """Print median, 99th percentile and largest of some delays."""
    median, late, latest = 1e3 * np.percentile(seconds, [50, 99, 100])
    print(f"{what}: {len(seconds)} answers, median {median:.1f}, p99 {late:.1f}, largest {latest:.1f} ms", flush=True)


def main():
    with tempfile.TemporaryDirectory() as folder, running_server(Path(folder) / "jobs.sqlite", KEY, workers=2, reserved=3) as server:
        statuses = []
        told("health, nothing else", health_beside(server.address, lambda: time.sleep(0.1), 10.0))
        told(f"health beside {len(BODY) / 1e6:.0f} MB of JSON", health_beside(server.address, lambda: statuses.append(flooded(server))))
        print("answers to the flood:", statuses[:3], len(statuses))
        with connections(server.address, 275, b"GET /health HTTP/1.1\r\nX-Slow: ") as lines:
            told("health beside 275 that drip", health_beside(server.address, lambda: drip(lines)))
        with connections(server.address, 400, b"") as lines:
            told("health beside 400 idle", health_beside(server.address, lambda: time.sleep(0.1)))
        told("dome of 121 beside long jobs", domes(server))


if __name__ == "__main__":
    sys.exit(main())
