"""A real server in a process of its own."""

from __future__ import annotations

import http.client
import json
import re
import socket
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

from compas_cgc.client import Client

KILLABLE = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="it looks for processes to kill in /proc")
KEY = "a-key-for-tests"
PATIENCE = 300.0  # seconds to wait for what comes at once when the machine has time for it

WITH_LIMITS = """
import json, sys
from compas_cgc.server import Limits, serve
asked = json.loads(sys.argv[1])
serve(limits=Limits(**asked.pop("limits")), **asked)
"""


class Running:
    """A server process and a client of it."""

    def __init__(self, process, url, key):
        self.process, self.url, self.key = process, url, key
        self.address = url.split("//")[1]
        self.client = Client(url, key, retries=2, timeout=PATIENCE)
        self.said = []

    def ask(self, method, path, body=None, timeout=PATIENCE, **headers):
        """Return status, headers and body of one raw request; the key is sent unless it is given otherwise."""
        connection = http.client.HTTPConnection(self.address, timeout=timeout)
        headers = {"RhinoComputeKey": self.key, **headers}
        try:
            connection.request(method, path, body, {name: value for name, value in headers.items() if value is not None})
            answer = connection.getresponse()
            return answer.status, answer.headers, answer.read()
        finally:
            connection.close()


@contextmanager
def running_server(store, key=None, workers=2, port=0, limits=None, reserved=1, **more):
    """Run ``compas-cgc serve``, or with limits of its own the function behind that.

    Fewer workers are reserved for blocking calls than by default, as each takes seconds to start.
    """
    if limits is None:
        # On a busy machine the first call of a worker, which compiles, may take longer than clients wait elsewhere.
        configuration = Path(store).with_suffix(".toml")
        configuration.write_text(f"[limits]\nblocking = {PATIENCE}\nreserved = {reserved}\n", encoding="utf-8")
        command = ["-m", "compas_cgc", "serve", "--port", str(port), "--workers", str(workers), "--store", str(store)]
        command += ["--config", str(configuration)]
        command += ["--key", key] if key else []
    else:
        asked = {"port": port, "key": key, "workers": workers, "store": str(store), "limits": {"reserved": reserved, **limits}, **more}
        command = ["-c", WITH_LIMITS, json.dumps(asked)]
    process = subprocess.Popen([sys.executable, *command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    said, url = [], None
    try:
        for line in process.stdout:
            said.append(line)
            found = re.search(r"is at (http://\S+)", line)
            url = found.group(1) if found else url
            if line.startswith("ready"):
                break
        assert url, "".join(said)
        running = Running(process, url, key if key is None or isinstance(key, str) else key[0])
        # A full pipe would stop the server.
        threading.Thread(target=running.said.extend, args=(process.stdout,), daemon=True).start()
        yield running
    finally:
        process.terminate()
        try:
            process.wait(PATIENCE)
        finally:
            process.kill()


@contextmanager
def running_rpc():
    """Run the service for COMPAS RPC, and yield a proxy of it that waits as long as it takes to start."""
    from compas.rpc import Proxy

    attempts = int(10 * PATIENCE)  # a tenth of a second each
    proxy = Proxy(
        service="compas_cgc.rpc.service",
        python=sys.executable,
        port=free_port(),
        autoreload=False,
        capture_output=False,
        max_conn_attempts=attempts,
    )
    process = proxy._process
    try:
        yield proxy
    finally:
        proxy.stop_server()
        process.wait(PATIENCE)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def wait_for(condition, seconds=PATIENCE, what="waited too long"):
    """Wait until something is so, and return it."""
    end = time.monotonic() + seconds
    while not (found := condition()):
        assert time.monotonic() < end, what
        time.sleep(0.01)
    return found


def descendants(pid):
    """Return the processor time of a process and of all that it started, or that these started, in clock ticks by process id."""
    parents, ticks = {}, {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            parent, *_, user, system = path.read_text().rpartition(")")[2].split()[1:13]
        except OSError:
            continue  # it has ended
        parents[int(path.parent.name)], ticks[int(path.parent.name)] = int(parent), int(user) + int(system)
    found, waiting = {}, [pid]
    while waiting:
        own = waiting.pop()
        found[own] = ticks.get(own, 0)
        waiting += [child for child, parent in parents.items() if parent == own]
    return found


def worker_of(server):
    """Return the process id of the worker of a server that works at the moment."""

    def times():
        found = descendants(server.process.pid)
        del found[server.process.pid]
        return found

    before = times()

    def busiest():
        spent, pid = max((spent - before.get(pid, spent), pid) for pid, spent in times().items())
        return pid if spent >= 10 else None

    return wait_for(busiest)
