"""Remote solve: on a server, with retries when the connection is lost."""

from __future__ import annotations

import json
import threading
import time
import uuid
from collections.abc import Callable
from collections.abc import Mapping
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any
from typing import Optional

import numpy as np

from ...client import Client
from ...client import ClientError
from ...client import Refused
from ...client import ServerUnavailable
from ...client.packed import pack
from ...datastructures import CGCMesh
from ...datastructures import SolveResult
from ...errors import CGCError
from ...model.constraint_data import constraint_data
from ...model.constraints import Constraint
from ...model.goals.wholes import Unknown
from ...model.problem import CGCProblem
from ...model.problem import PosesProblem
from ...model.result import History
from ...solvers import Settings
from ...solvers.registry import method_of
from .address import Address
from .progress import Progress
from .progress import ProgressMeter
from .progress import Report

__all__ = ["remote_solve", "request_body"]

POLL_INTERVAL = 0.1  # time between two status requests [s]
RETRY_INTERVAL = 1.0  # time until a retry after a lost connection [s]
UNKNOWN_JOB = (404, 410)  # HTTP statuses of a server that does not know the job


def remote_solve(
    mesh: PosesProblem, settings: Optional[Settings], goals: Sequence[Constraint], server: Address
) -> Callable[[Report], SolveResult]:
    """Return a function that solves on a server, for a background task.

    Requests are retried until the server responds or the task is cancelled. If the server was
    restarted and does not know the job, the job is submitted again.

    Parameters
    ----------
    mesh, settings, goals
        As for :func:`compas_cgc.grasshopper.runtime.local_solve.local_solve`.
    server
        The server.
    """

    def run(report: Report) -> SolveResult:
        client = Client(server.url, server.key, retries=0, timeout=10.0)
        problem = mesh.to_problem().with_goals(goals)
        id = uuid.uuid4().hex
        try:
            answer = _answer(client, id, request_body(id, problem, settings), ProgressMeter(problem.target_scale), report)
        except BaseException:
            # The task may be interrupted in the middle of a request; it does not wait for the server.
            threading.Thread(target=_cancel, args=(client, id), daemon=True).start()
            raise
        return _result(problem, answer, settings, mesh)

    return run


def _answer(client: Client, id: str, body: bytes, meter: ProgressMeter, report: Report) -> dict:
    """Submit a job, with retries, and return its result."""
    progress, submitted = Progress(), False
    while True:
        shown, pause = progress, POLL_INTERVAL
        try:
            if not submitted:
                client.request("POST", "/api/v1/jobs", body)
                submitted = True
            status = client.poll(id)
            if status["state"] == "succeeded":
                return client.result(id)
            if status["state"] in ("failed", "cancelled"):
                raise CGCError(status["message"] or f"the server reports that the job is {status['state']}")
            if status["error"] is not None:
                shown = progress = meter.at(status["iteration"], status["error"])
        except ServerUnavailable as lost:
            shown, pause = progress._replace(note=f"{lost}; retrying"), RETRY_INTERVAL
        except Refused as error:
            if error.status not in UNKNOWN_JOB or not submitted:
                raise CGCError(str(error)) from None
            submitted = False
        if report(shown):
            raise CGCError("cancelled")
        time.sleep(pause)


def _cancel(client: Client, id: str) -> None:
    with suppress(ClientError):
        client.cancel(id)


def request_body(id: str, problem: CGCProblem, settings: Optional[Settings] = None) -> bytes:
    """Return the body of a request; a request with the same `id` refers to the same job."""
    body = {
        "id": id,
        **_settings(settings),
        **(_compas_mesh(problem) if _needs_compas(problem) else _arrays(problem)),
        "goals": [constraint_data(constraint) for constraint in problem.goals],
        **({"laws": {str(region): str(law) for region, law in problem.laws.items()}} if problem.laws else {}),
    }
    return json.dumps(body, allow_nan=False).encode("utf-8")


def _settings(settings: Optional[Settings]) -> dict[str, Any]:
    if settings is None:
        return {}
    given = {name: value for name, value in settings.to_dict().items() if value is not None}
    return {"method": method_of(settings), "settings": given}


def _needs_compas(problem: CGCProblem) -> bool:
    """Check whether arrays cannot represent a problem: strategies of single creases, or roles that do not follow from the geometry."""
    if np.isfinite(problem.s).any() or np.isfinite(problem.e).any():
        return True
    plain = CGCProblem(problem.vertices, problem.faces, creases=problem.creases)
    return not np.array_equal(plain.with_supports(problem.supports).roles, problem.roles)


def _compas_mesh(problem: CGCProblem) -> dict[str, Any]:
    """Return a problem as COMPAS JSON, which is slower than arrays."""
    data = CGCMesh.from_problem(problem).__data__
    # Constraints are sent in the body, as for arrays.
    data["attributes"].pop("goals", None)
    return {"mesh": {"dtype": "compas_cgc.datastructures/CGCMesh", "data": data}}


def _arrays(problem: CGCProblem) -> dict[str, Any]:
    return {
        "vertices": pack(problem.vertices, "f8", 3),
        "faces": pack(problem.faces, "i4", 3),
        "supports": problem.supports.tolist(),
        "creases": problem.creases.tolist(),
        "targets": [K if K == K else None for K in problem.targets.tolist()],
    }


def _result(problem: CGCProblem, answer: Mapping[str, Any], settings: Optional[Settings], mesh: PosesProblem) -> SolveResult:
    """Return the response of a server as the result of a local solve."""
    columns = (answer["history"][name] for name in History._fields)
    real = problem.without_dummies()
    if any(isinstance(own, Unknown) for own in real.goals):
        real = real.with_targets(np.array(answer["targets"], dtype=np.float64))
    faces = np.array(answer["faces"], dtype=np.int64)
    turned = int(np.count_nonzero((faces != real.faces).any(axis=1)))
    return SolveResult(
        replace(real.with_vertices(answer["vertices"]), faces=faces),
        answer["status"],
        answer["ending"],
        answer["iterations"],
        answer["seconds"],
        np.nan if answer["max_error"] is None else answer["max_error"],
        History.from_rows(list(zip(*columns))),
        answer["method"],
        settings=settings,
        drawn=mesh if isinstance(mesh, CGCMesh) and not turned else None,
        start=real.vertices,
        measure=answer["measure"],
        turned=turned,
    )
