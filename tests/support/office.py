"""A server that an office shares: ``python -m tests.support.office eleventh 120`` and ``python -m tests.support.office bodies 256 60``.

*eleventh*: ten clients send long jobs, long calls of Hops and hostile uploads for some seconds; an eleventh asks for short calls of
Hops and downloads a .3dm file. *bodies*: a number of bodies of some MB wait behind a long job, and all are deleted.
"""

from __future__ import annotations

import itertools
import json
import random
import re
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import numpy as np

from compas_cgc.client import Client
from compas_cgc.client import Refused

from .server_process import running_server
from .server_process import wait_for
from .shapes import grid
from .soak import OVER
from .soak import hops_body
from .soak import job_asked

CLIENTS = 10
KINDS = ("job", "call", "upload")
KEYS = [f"key-of-client-{k:02d}" for k in range(CLIENTS + 1)]
FORMATS = {
    "obj": [b"v 0 0 0 \\\n" * 1_000_000, b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf " + b"1 2 3 " * 500_000],
    "ply": [b"ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty double x\nend_header\n" + b"0 " * 4_000_000],
    "off": [b"OFF\n99999999999 1 0\n" + b"0 0 0\n" * 1_000_000],
    "dxf": [b"0\nSECTION\n2\nENTITIES\n" + b"0\nLINE\n8\n0\n10\n0\n20\n0\n11\n1\n21\n1\n" * 100_000],
    "3dm": [b"3D Geometry File Format " + b"\xff" * 4_000_000],
}


def asked_for(kind: str, chance: random.Random) -> tuple[str, bytes]:
    """Return the path and body of a request that keeps a server busy: one of KINDS."""
    if kind == "call":
        return "/solve", hops_body(60, 0.003 + 1e-7 * chance.random(), "flow", Steps=10_000)
    if kind == "job":
        job = {name: getattr(value, "tolist", lambda value=value: value)() for name, value in job_asked(40, 0.004).items()}
        settings = {"steps": 100_000, "tolerance": 0.0}
        return "/api/v1/jobs", json.dumps({**job, "method": "flow", "settings": settings}).encode()
    suffix = chance.choice(list(FORMATS))
    return f"/api/v1/jobs?kind={suffix}", chance.choice(FORMATS[suffix])


def eleventh(seconds: float, workers: int = 2) -> tuple[dict[str, list[float]], Counter]:
    """Return how long the eleventh client waits [s] for its calls and downloads, and the answers to the ten."""
    with (
        tempfile.TemporaryDirectory() as folder,
        running_server(Path(folder) / "jobs.sqlite", KEYS, workers, limits={"reserved": 3}) as server,
    ):
        mine = Client(server.url, KEYS[-1], retries=0, timeout=120.0)
        id = mine.submit(**job_asked(12, 0.004))
        wait_for(lambda: mine.poll(id)["state"] in OVER)
        assert server.ask("POST", "/solve", hops_body(10, 0.004), RhinoComputeKey=KEYS[-1])[0] == 200
        end, answers = time.monotonic() + seconds, Counter()

        def bother(client: int, kind: str) -> None:
            chance = random.Random(f"{client} {kind}")
            while time.monotonic() < end:
                path, body = asked_for(kind, chance)
                try:
                    answers[kind, server.ask("POST", path, body, RhinoComputeKey=KEYS[client])[0]] += 1
                except OSError as error:
                    answers[kind, type(error).__name__] += 1
                time.sleep(0.05)

        for client, kind in itertools.product(range(CLIENTS), KINDS):
            threading.Thread(target=bother, args=(client, kind), daemon=True).start()
        time.sleep(min(5.0, 0.2 * seconds))
        waited: dict[str, list[float]] = {"Hops": [], "3dm": []}
        for number in itertools.takewhile(lambda _: time.monotonic() < end, itertools.count()):
            started = time.monotonic()
            status = server.ask("POST", "/solve", hops_body(10, 0.004 + 1e-6 * number), RhinoComputeKey=KEYS[-1])[0]
            waited["Hops"].append(time.monotonic() - started)
            assert status == 200, status
            started = time.monotonic()
            assert mine.result(id, "3dm").startswith(b"3D Geometry File Format")
            waited["3dm"].append(time.monotonic() - started)
            time.sleep(0.2)
        # Without the calls that the end of the server breaks off.
        return waited, Counter(answers)


class Queued(NamedTuple):
    """What bodies that wait cost."""

    accepted: int
    refused: Counter
    megabytes: float  # largest resident size of the server and its workers
    kept: float  # size of the store while they wait [MB]
    left: float  # a minute after all are deleted, or as soon as it is below 10 MB
    seconds: float  # until then


def bodies(count: int, megabytes: float) -> Queued:
    """Let bodies wait behind a long job, and delete them."""
    vertices, faces = grid(6)
    mesh = "".join(f"v {x} {y} {z}\n" for x, y, z in vertices) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)
    body = mesh.encode() + b"# no more\n" * int(megabytes * 1e5)
    limits = {"reserved": 1, "body": int(2e6 * megabytes)}
    with tempfile.TemporaryDirectory() as folder, running_server(Path(folder) / "jobs.sqlite", KEYS, 1, limits=limits) as server:
        clients = [Client(server.url, key, retries=0, timeout=300.0) for key in KEYS]
        settings = {"steps": 100_000, "tolerance": 0.0}
        for _ in range(2):
            clients[-1].submit(**job_asked(40, 0.004), method="flow", settings=settings)
        largest, over, ids, refused = [0.0], threading.Event(), [], Counter()

        def look() -> None:
            while not over.wait(0.1):
                largest.append(resident(server.process.pid))

        watch = threading.Thread(target=look)
        watch.start()
        numbers, lock = iter(range(count)), threading.Lock()

        def send() -> None:
            while True:
                with lock:
                    number = next(numbers, None)
                if number is None:
                    return
                key = KEYS[number % CLIENTS]
                for _ in range(60):
                    status, _, content = server.ask("POST", "/api/v1/jobs?kind=obj", body, RhinoComputeKey=key)
                    if status == 202:
                        ids.append((number % CLIENTS, json.loads(content)["id"]))
                        break
                    refused[status, json.loads(content)["message"][:80]] += 1
                    if status != 429:
                        break
                    time.sleep(1.0)

        senders = [threading.Thread(target=send) for _ in range(8)]
        for thread in senders:
            thread.start()
        for thread in senders:
            thread.join()
        kept, started = size_of(Path(folder)), time.monotonic()
        for client, id in ids:
            try:
                clients[client].cancel(id)
                clients[client].delete(id)
            except Refused:
                pass
        while (left := size_of(Path(folder))) > 10.0 and time.monotonic() - started < 60.0:
            time.sleep(0.2)
        seconds = time.monotonic() - started
        over.set()
        watch.join()
        return Queued(len(ids), refused, max(largest), kept, left, seconds)


def size_of(folder: Path) -> float:
    """Return the size of all files in a folder [MB]."""
    total = 0
    for path in folder.rglob("*"):
        try:
            total += path.stat().st_size
        except OSError:
            continue  # deleted meanwhile
    return total / 1e6


def resident(pid: int) -> float:
    """Return the resident memory of a server without that of its workers [MB]."""
    listed = subprocess.run(["ps", "-o", "rss=", "-p", str(pid)], capture_output=True, text=True).stdout
    return sum(int(own) for own in re.findall(r"\d+", listed)) / 1024


def main() -> int:
    """Print what an office meets."""
    if sys.argv[1] == "bodies":
        print(bodies(int(sys.argv[2]), float(sys.argv[3])))
        return 0
    waited, answers = eleventh(float(sys.argv[2]))
    for what, seconds in waited.items():
        median, late, latest = np.percentile(seconds, [50, 99, 100])
        print(f"{what}: {len(seconds)} answers, median {median:.2f}, p99 {late:.2f}, largest {latest:.2f} s")
    print(dict(answers))
    return 0


if __name__ == "__main__":
    sys.exit(main())
