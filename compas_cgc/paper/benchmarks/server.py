"""Benchmark of the server: jobs and Hops calls relative to the solve itself."""

from __future__ import annotations

import http.client
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Iterable
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Callable
from typing import Optional

import numpy as np

from ...analysis import analyse
from ...client import Client
from ...datastructures import CGCMesh
from ...io.rhino.meshes import mesh_from_arrays
from ...model.problem import CGCProblem
from ...solvers.run import solve
from .solves import square

__all__ = ["server_overhead"]

MIN_ROUNDS, MAX_ROUNDS, BUDGET = 3, 25, 20.0  # time budget [s] for rounds beyond the minimum


def server_overhead(sizes: tuple[int, ...] = (1_024, 10_000)) -> list[dict]:
    """Return the time of solving a dome over a fixed square on the server, relative to a local solve.

    A job, including its analysis, is compared with a local solve and analysis; a Hops call is compared with the solve of a mesh. All are
    run alternately and the medians of their ratios are reported, to reduce the influence of other load. Ratios of CPU time (client,
    server and workers together) depend even less on other load.

    Parameters
    ----------
    sizes
        Approximate numbers of vertices.

    Returns
    -------
    list of dict
        Results by name, one dict per size.

    Examples
    --------
    >>> server_overhead((1024,))[0]["job_overhead"]  # doctest: +SKIP
    """
    with _server() as (client, process):
        return [_row(client, process, square(round(size**0.5) - 1)) for size in sizes]


def _row(client: Client, process: int, problem: CGCProblem) -> dict:
    mesh = CGCMesh.from_vertices_and_faces(problem.vertices, problem.faces)
    mesh.set_supports("boundary")
    mesh.set_target(1.0)
    body = _hops_request(problem)
    doings: dict[str, Callable[[], object]] = {
        "solve": lambda: solve(mesh),
        "analysed": lambda: analyse(solve(problem), problem),
        "job": lambda: client.solve(problem.vertices, problem.faces, supports="boundary", targets=1.0),
        "hops": lambda: client.request("POST", "/solve", body),
    }
    spent = _taking_turns(doings, process)
    return {
        "vertices": len(problem.vertices),
        **{f"{name}_seconds": _median([wall for wall, _ in spent[name]]) for name in doings},
        "job_ratio": _ratio(spent, "job", "analysed"),
        "hops_ratio": _ratio(spent, "hops", "solve"),
        "job_cpu_ratio": _cpu_ratio(spent, "job", "analysed"),
        "hops_cpu_ratio": _cpu_ratio(spent, "hops", "solve"),
        "cancel_seconds": _cancel(client, problem),
        "hang_up_seconds": _hang_up(client, problem),
    }


Spent = dict[str, list[tuple[float, float]]]  # wall time and CPU time [s] of every round, by task


def _taking_turns(doings: dict[str, Callable[[], object]], process: int) -> Spent:
    for doing in doings.values():
        doing()
    spent: Spent = {name: [] for name in doings}
    began = time.perf_counter()
    while len(spent["job"]) < MIN_ROUNDS or (time.perf_counter() - began < BUDGET and len(spent["job"]) < MAX_ROUNDS):
        for name, doing in doings.items():
            cpu, wall = _cpu(process), time.perf_counter()
            doing()
            spent[name].append((time.perf_counter() - wall, _cpu(process) - cpu))
    return spent


def _median(values: list[float]) -> float:
    return float(np.median(values))


def _ratio(spent: Spent, name: str, other: str) -> float:
    return _median([one[0] / against[0] for one, against in zip(spent[name], spent[other])])


def _cpu_ratio(spent: Spent, name: str, other: str) -> Optional[float]:
    # CPU time has a resolution of 0.01 s, so sums are compared.
    one, against = (sum(cpu for _, cpu in spent[own]) for own in (name, other))
    return one / against if against > 0 else None


def _cpu(process: int) -> float:
    """Return the CPU time of this process, a server and its workers so far [s], 0 if not available."""
    found = time.process_time()
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            _, parent, *_, user, system = path.read_text().rpartition(")")[2].split()[:13]
        except (OSError, ValueError):
            continue  # the process has ended
        if process in (int(path.parent.name), int(parent)):
            found += (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")
    return found if Path("/proc/self/stat").exists() else 0.0


def _cancel(client: Client, problem: CGCProblem, times: int = 5) -> float:
    """Return the longest time from the request to cancel a running solve until the job has ended [s]."""
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
    """Return the longest time from the disconnection of a Hops client until its worker is free [s]."""
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
def _server() -> Iterator[tuple[Client, int]]:
    """Run a separate server on a free port within a block; yield a client and the process id."""
    command = [sys.executable, "-m", "compas_cgc", "serve", "--port", "0", "--workers", "1", "--store", ":memory:"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        yield Client(_address(process.stdout or ())), process.pid
    finally:
        process.terminate()
        process.wait(10)


def _address(lines: Iterable[str]) -> str:
    """Return the address of a server from its output, once it is ready."""
    url = ""
    for line in lines:
        found = re.search(r"is at (http://\S+)", line)
        url = found.group(1) if found else url
        if line.startswith("ready"):
            return url
    raise RuntimeError("the server ended before it was ready")
