"""Benchmark of the server: jobs and calls of Hops against the solve itself."""

from __future__ import annotations

import http.client
import json
import re
import subprocess
import sys
import time
from collections.abc import Iterable
from collections.abc import Iterator
from contextlib import contextmanager

from ...client import Client
from ...datastructures import CGCMesh
from ...io.rhino.meshes import mesh_from_arrays
from ...model.problem import CGCProblem
from ...solvers.run import solve
from .solves import square
from .timing import best_of

__all__ = ["server_overhead"]


def server_overhead(sizes: tuple[int, ...] = (1_024, 10_000)) -> list[dict]:
    """Return what a dome over a fixed square takes here, as a job from numbers to numbers, and by Hops.

    Parameters
    ----------
    sizes
        Numbers of vertices, roughly.
    """
    with _server() as client:
        return [_row(client, square(round(size**0.5) - 1)) for size in sizes]


def _row(client: Client, problem: CGCProblem) -> dict:
    mesh = CGCMesh.from_vertices_and_faces(problem.vertices, problem.faces)
    mesh.set_supports("boundary")
    mesh.set_target(1.0)
    body = _hops_request(problem)
    solve_seconds = best_of(lambda: solve(mesh))
    job_seconds = best_of(lambda: client.solve(problem.vertices, problem.faces, supports="boundary", targets=1.0))
    hops_seconds = best_of(lambda: client.request("POST", "/solve", body))
    return {
        "vertices": len(problem.vertices),
        "solve_seconds": solve_seconds,
        "job_seconds": job_seconds,
        "job_overhead": job_seconds / solve_seconds - 1.0,
        "hops_seconds": hops_seconds,
        "hops_more_seconds": hops_seconds - solve_seconds,
        "cancel_seconds": _cancel(client, problem),
        "hang_up_seconds": _hang_up(client, problem),
    }


def _cancel(client: Client, problem: CGCProblem, times: int = 5) -> float:
    """Return the longest time from the wish to cancel a running solve until the job is over."""
    longest = 0.0
    for _ in range(times):
        endless = {"steps": 100_000, "tolerance": 0.0, "finish": False}
        id = client.submit(problem.vertices, problem.faces, supports="boundary", targets=1.0, method="flow", settings=endless)
        while client.poll(id, wait=0.05)["iteration"] < 2:
            pass
        started = time.perf_counter()
        client.cancel(id)
        client.poll(id, wait=10.0)
        longest = max(longest, time.perf_counter() - started)
        client.delete(id)
    return longest


def _hang_up(client: Client, problem: CGCProblem, times: int = 3) -> float:
    """Return the longest time from when a client of Hops hangs up until the worker that solved for it is free."""
    longest = 0.0
    for _ in range(times):
        connection = http.client.HTTPConnection(client.url.split("//")[1], timeout=30.0)
        connection.request("POST", "/solve", _hops_request(problem, "flow", Steps=10_000))
        while not client.health()["busy"]:
            time.sleep(0.005)
        started = time.perf_counter()
        connection.close()
        while client.health()["busy"]:
            time.sleep(0.005)
        longest = max(longest, time.perf_counter() - started)
    return longest


def _hops_request(problem: CGCProblem, function: str = "dome", **more: int) -> bytes:
    mesh = json.dumps(mesh_from_arrays(problem.vertices, problem.faces).Encode())
    values = [
        {"ParamName": "Mesh", "InnerTree": {"{0}": [{"type": "Rhino.Geometry.Mesh", "data": mesh}]}},
        {"ParamName": "K", "InnerTree": {"{0}": [{"type": "System.Double", "data": "1"}]}},
    ]
    values += [{"ParamName": name, "InnerTree": {"{0}": [{"data": value}]}} for name, value in more.items()]
    return json.dumps({"pointer": f"cgc/{function}", "modelunits": "Meters", "values": values}).encode()


@contextmanager
def _server() -> Iterator[Client]:
    """Run a server of its own at any free port while a block runs."""
    command = [sys.executable, "-m", "compas_cgc", "serve", "--port", "0", "--workers", "1", "--store", ":memory:"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        yield Client(_address(process.stdout or ()))
    finally:
        process.terminate()
        process.wait(10)


def _address(lines: Iterable[str]) -> str:
    """Return where a server is by what it says, once it is ready."""
    url = ""
    for line in lines:
        found = re.search(r"is at (http://\S+)", line)
        url = found.group(1) if found else url
        if line.startswith("ready"):
            return url
    raise RuntimeError("the server ended before it was ready")
