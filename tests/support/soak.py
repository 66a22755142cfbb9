"""Many clients at once for a while: ``python -m tests.support.soak --clients 50 --seconds 120``.

They solve meshes of mixed sizes as Hops components, at once and by submit and fetch, and through the job API; download
results, follow events, send what is wrong or far too much, hand in the same job twice, cancel some of their jobs and hang
up on some of their calls. Every answer is compared with the known one: none is lost, wrong, double or a fault of the server
(5xx); memory and delays are shown at the end.
"""

from __future__ import annotations

import argparse
import http.client
import json
import multiprocessing
import random
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path

import numpy as np

from compas_cgc.client import Client
from compas_cgc.client import Refused
from compas_cgc.io.rhino.meshes import mesh_from_arrays

from .server_process import PATIENCE
from .server_process import descendants
from .server_process import running_server
from .shapes import grid

SIZES = (6, 12, 20, 31)
OVER = ("succeeded", "failed", "cancelled")
LIMITS = {"reserved": 3, "grace": 60.0}  # on a busy machine too, no worker is ended by force that would end by itself


def hops_body(n, K, name="dome", **more):
    """Return the body of a request of Hops that is always computed."""
    data = {"Mesh": mesh_from_arrays(*grid(n, 9.0)).Encode(), "K": K, **more}
    values = [{"ParamName": own, "InnerTree": {"{0}": [{"data": value}]}} for own, value in data.items()]
    return json.dumps({"pointer": f"cgc/{name}", "cachesolve": False, "values": values}).encode()


def job_asked(n, K):
    vertices, faces = grid(n, 9.0)
    return {"vertices": vertices, "faces": faces, "supports": "boundary", "targets": K}


def mesh_of(content):
    """Return the coloured surface in an answer to Hops, which is the same every time."""
    return next(value for value in json.loads(content)["values"] if value["ParamName"] == "Mesh")["InnerTree"]["{0}"][0]["data"]


class Tally:
    """What the clients met, from all of their threads."""

    def __init__(self):
        self.lock = threading.Lock()
        self.counts, self.wrong, self.times = Counter(), [], {}

    def count(self, what):
        with self.lock:
            self.counts[what] += 1

    def took(self, what, seconds):
        with self.lock:
            self.times.setdefault(what, []).append(seconds)

    def complain(self, text):
        with self.lock:
            self.wrong.append(text)


class Visitor(threading.Thread):
    """A client that does one thing after another until the time is over."""

    def __init__(self, server, known, tally, number, end):
        super().__init__(daemon=True)
        self.server, self.known, self.tally, self.end = server, known, tally, end
        self.chance = random.Random(number)
        self.client = Client(server.url, retries=8, timeout=PATIENCE)

    def run(self):
        doings = [self.call, self.call, self.job, self.job, self.cancel, self.hang_up]
        doings += [self.bad, self.download, self.events, self.twice, self.fetch]
        while time.monotonic() < self.end:
            doing = self.chance.choice(doings)
            try:
                doing(self.chance.choice(SIZES), round(0.002 + 0.001 * self.chance.randrange(5), 4))
            except Exception as error:
                self.tally.complain(f"{doing.__name__}: {type(error).__name__} {error}")

    def call(self, n, K):
        started = time.monotonic()
        status, _, content = self.server.ask("POST", "/solve", hops_body(n, K), timeout=PATIENCE)
        if status == 429:
            self.tally.count("calls refused, busy")
            time.sleep(0.2)
            return
        self.tally.took(f"call {(n + 1) ** 2:5d}", time.monotonic() - started)
        self.tally.count("calls")
        if status != 200 or mesh_of(content) != self.known["call", n, K]:
            self.tally.complain(f"a wrong answer to a call of {n}, {K}: {status} {content[:200]}")

    def job(self, n, K):
        started = time.monotonic()
        found = self.client.solve(**job_asked(n, K), interval=0.3)
        self.tally.took(f"job  {(n + 1) ** 2:5d}", time.monotonic() - started)
        self.tally.count("jobs")
        if not np.array_equal(found["vertices"], self.known["job", n, K]):
            self.tally.complain(f"a wrong result of a job of {n}, {K}")

    def cancel(self, n, K):
        settings = {"steps": 100000, "tolerance": 0.0}
        id = self.client.submit(**{**job_asked(n, K), "targets": K}, method="flow", settings=settings)
        time.sleep(self.chance.uniform(0.0, 0.5))
        was = self.client.poll(id)["state"]
        started = time.monotonic()
        self.client.cancel(id)
        while self.client.poll(id)["state"] not in OVER:
            time.sleep(0.01)
            if time.monotonic() - started > PATIENCE:
                self.tally.complain("a job that does not end")
                return
        self.tally.took(f"cancel {was}", time.monotonic() - started)
        self.tally.count("cancels")
        if self.client.poll(id)["state"] != "cancelled":
            self.tally.complain(f"a cancelled job is {self.client.poll(id)}")

    def bad(self, n, K):
        asked = {name: getattr(value, "tolist", lambda value=value: value)() for name, value in job_asked(n, K).items()}
        flood = b"{" + b",".join(b'"key%d":1' % k for k in range(200_000)) + b"}"
        path, body, wanted = self.chance.choice(
            [
                ("/api/v1/jobs", json.dumps({**asked, "targets": [1.0]}).encode(), 422),
                ("/api/v1/jobs", json.dumps({**asked, "faces": [[0, 1, 10**6]]}).encode(), 422),
                ("/api/v1/jobs", flood, 422),
                ("/api/v1/jobs", b"{", 400),
                ("/solve", flood, 404),
                ("/solve", hops_body(n, K, "none"), 404),
                ("/api/v1/jobs?kind=obj", b"no such file", 202),
                ("/api/v1/nothing", b"", 404),
            ]
        )
        status, _, content = self.server.ask("POST", path, body, timeout=PATIENCE)
        if status == 202:
            id = json.loads(content)["id"]
            while (state := self.client.poll(id, wait=1.0)["state"]) not in OVER:
                pass
            status = 202 if state == "failed" else state
        self.count_or_complain("refusals", status in (wanted, 429) and "message" in json.loads(content) or status == 202, (status, content))

    def download(self, n, K):
        id = self.client.submit(**job_asked(n, K))
        while self.client.poll(id, wait=1.0)["state"] not in OVER:
            pass
        kind = self.chance.choice(("3dm", "obj", "compas", "hops", "packed"))
        content = self.client.result(id, kind)
        begins = {"3dm": b"3D Geometry File Format", "compas": b'{"dtype"', "hops": b'{"version"', "packed": b'{"status"'}
        good = content.startswith(begins[kind]) if kind in begins else content.count(b"\nv ") + content.startswith(b"v ") == (n + 1) ** 2
        self.count_or_complain("downloads", good, (kind, content[:200]))

    def events(self, n, K):
        id = self.client.submit(**job_asked(n, K))
        status, _, content = self.server.ask("GET", f"/api/v1/jobs/{id}/events", timeout=PATIENCE)
        ends = content.decode().strip().split("\n\n")[-1]
        self.count_or_complain("event streams", status == 429 or ends.startswith("event: done"), (status, ends))

    def twice(self, n, K):
        id = f"soak-{self.chance.getrandbits(60):x}-twice"
        found = {self.client.submit(**job_asked(n, K), id=id) for _ in range(2)}
        while (status := self.client.poll(id, wait=1.0))["state"] not in OVER:
            pass
        one = sum(job["id"] == id for job in json.loads(self.server.ask("GET", "/api/v1/jobs?limit=1000")[2])["jobs"])
        self.count_or_complain("jobs sent twice", found == {id} and one == 1 and status["state"] == "succeeded", (found, one, status))

    def fetch(self, n, K):
        values = json.loads(hops_body(n, [K], "submit"))
        for value in values["values"]:
            if value["ParamName"] == "K":
                value["InnerTree"]["{0}"] = [{"data": K}]
        status, _, content = self.server.ask("POST", "/solve", json.dumps(values).encode(), timeout=PATIENCE)
        if status == 429:
            self.tally.count("submits refused, busy")
            time.sleep(0.2)
            return
        job = json.loads(content)["values"][0]["InnerTree"]["{0}"][0]["data"]
        body = json.dumps({"pointer": "cgc/fetch", "values": [{"ParamName": "Job", "InnerTree": {"0": [{"data": job}]}}]}).encode()
        while (answer := self.server.ask("POST", "/solve", body, timeout=PATIENCE))[0] == 202:
            time.sleep(0.1)
        good = answer[0] == 200 and mesh_of(answer[2]) == self.known["call", n, K]
        self.count_or_complain("fetches", good, (answer[0], answer[2][:200]))

    def count_or_complain(self, what, good, found):
        self.tally.count(what)
        if not good:
            self.tally.complain(f"{what}: {str(found)[:400]}")

    def hang_up(self, n, K):
        connection = http.client.HTTPConnection(self.server.address, timeout=PATIENCE)
        connection.request("POST", "/solve", hops_body(40, K, "flow", Steps=10000))
        time.sleep(self.chance.uniform(0.0, 0.5))
        connection.close()
        self.tally.count("hang-ups")


class Watch(multiprocessing.get_context("spawn").Process):
    """Looks at the memory of the server, and at how fast ``/health`` and a cancel are; not slowed down by the other clients."""

    def __init__(self, url, server, seconds):
        super().__init__(daemon=True)
        self.url, self.server, self.seconds = url, server, seconds
        self.news = multiprocessing.get_context("spawn").Queue()

    def run(self):
        client, started, look = Client(self.url, retries=0, timeout=30.0), time.monotonic(), 0.0
        while (now := time.monotonic() - started) < self.seconds:
            self.told("health of a watcher", client.health)
            if now >= look:
                look = now + 2.0
                self.news.put(("memory", (now, *memory_of(self.server))))
                self.told("cancel by a watcher", self.cancelled, client)
            time.sleep(0.2)
        self.news.put(("end", None))

    def told(self, what, function, *args):
        started = time.monotonic()
        try:
            seconds = function(*args)
            self.news.put((what, seconds if isinstance(seconds, float) else time.monotonic() - started))
        except Refused:
            pass
        except Exception as error:
            self.news.put(("wrong", f"{what}: {error!r}"))

    def cancelled(self, client):
        asked = job_asked(12, 0.004)
        id = client.submit(**asked, method="flow", settings={"steps": 100000, "tolerance": 0.0})
        while client.poll(id)["iteration"] == 0:
            time.sleep(0.02)
        started = time.monotonic()
        client.cancel(id)
        while client.poll(id)["state"] not in OVER:
            time.sleep(0.005)
        return time.monotonic() - started

    def tell(self, tally):
        """Hand over what was seen, and return the memory over time."""
        memory = []
        while (news := self.news.get(timeout=60))[0] != "end":
            what, found = news
            if what == "memory":
                memory.append(found)
            elif what == "wrong":
                tally.complain(found)
            else:
                tally.took(what, found)
        return memory


def memory_of(pid):
    """Return the resident memory of a server and the largest of its workers [MB]."""
    listed = subprocess.run(["ps", "-A", "-o", "pid=", "-o", "rss="], capture_output=True, text=True, check=True).stdout
    sizes = {int(own): int(size) / 1024 for own, size in map(str.split, listed.splitlines())}
    workers = [sizes.get(own, 0.0) for own in descendants(pid) if own != pid]
    return sizes.get(pid, 0.0), max(workers, default=0.0)


def known_answers(server):
    """Return all the answers, found one after another while nobody else is there."""
    known = {}
    for n in SIZES:
        for k in range(5):
            K = round(0.002 + 0.001 * k, 4)
            status, _, content = server.ask("POST", "/solve", hops_body(n, K))
            assert status == 200, content[:300]
            known["call", n, K] = mesh_of(content)
            known["job", n, K] = server.client.solve(**job_asked(n, K))["vertices"]
    return known


def report(tally, memory, seconds):
    """Print what was met; tell whether all was well."""
    print("\n".join(f"{name:22}{count:8d}" for name, count in sorted(tally.counts.items())))
    print(f"\n{'seconds':22}{'count':>8}{'median':>9}{'95 %':>9}{'max':>9}")
    for name, times in sorted(tally.times.items()):
        print(f"{name:22}{len(times):8d}{np.median(times):9.3f}{np.percentile(times, 95):9.3f}{max(times):9.3f}")
    memory = np.array(memory)
    print(f"\n{'memory [MB]':22}{'start':>9}{'end':>9}{'max':>9}{'slope / min':>13}")
    for name, column in (("server", 1), ("largest worker", 2)):
        grown = slope(memory, column)
        print(f"{name:22}{memory[0, column]:9.1f}{memory[-1, column]:9.1f}{memory[:, column].max():9.1f}{grown:13.2f}")
    print("server over time [s: MB]: " + ", ".join(f"{when:.0f}: {size:.0f}" for when, size, _ in memory[:: max(1, len(memory) // 20)]))
    print(f"\n{len(tally.wrong)} complaints in {seconds:g} seconds")
    print("\n".join(tally.wrong[:20]))
    return not tally.wrong


def slope(memory, column):
    """Return by how much memory grows in the second half of the time [MB a minute]."""
    late = np.array(memory)[len(memory) // 2 :]
    return 60 * np.polyfit(late[:, 0], late[:, column], 1)[0] if len(late) > 2 else float("nan")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--clients", type=int, default=50)
    parser.add_argument("--seconds", type=float, default=120.0)
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()
    tally, memory = soak(arguments.clients, arguments.seconds, arguments.workers)
    return 0 if report(tally, memory, arguments.seconds) else 1


def soak(clients, seconds, workers=2):
    """Let many clients at a server for a while; return what they met, and its memory over time."""
    with tempfile.TemporaryDirectory() as folder, running_server(Path(folder) / "jobs.sqlite", workers=workers, limits=LIMITS) as server:
        known = known_answers(server)
        print(f"{len(known)} answers known; {clients} clients for {seconds:g} seconds", flush=True)
        tally, end = Tally(), time.monotonic() + seconds
        watch = Watch(server.url, server.process.pid, seconds)
        visitors = [Visitor(server, known, tally, number, end) for number in range(clients)]
        for thread in (watch, *visitors):
            thread.start()
        memory = watch.tell(tally)
        for thread in visitors:
            thread.join(2 * PATIENCE)
        health = server.client.health()
        if any(visitor.is_alive() for visitor in visitors):
            tally.complain("a client that waits for ever")
        if (health["busy"], health["waiting"], health["replaced"]) != (0, 0, 0):
            tally.complain(f"after all the server is {health}")
        # The newest jobs: none is left unfinished, whatever became of its client.
        left = [status for status in server.client.jobs() if status["state"] not in OVER]
        if left:
            tally.complain(f"{len(left)} jobs are left")
        return tally, memory


if __name__ == "__main__":
    sys.exit(main())
