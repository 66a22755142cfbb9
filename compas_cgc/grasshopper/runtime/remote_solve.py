"""Solves by a server, which may go away and come back."""

from __future__ import annotations

import json
import time
import uuid
from collections.abc import Callable
from typing import Any

import numpy as np

from ...client import Client
from ...client import Refused
from ...client import ServerUnavailable
from ...client.packed import pack
from ...datastructures import CGCMesh
from ...errors import CGCError
from ...model.constraint_data import constraint_data
from ...model.problem import CGCProblem
from ...solvers.registry import SETTINGS
from .background import Progress
from .local_solve import GOAL
from .local_solve import Question
from .local_solve import Solved
from .local_solve import part_done
from .local_solve import report_text

__all__ = ["remote_job", "request_body"]

LOOK = 0.1  # seconds between two looks
AGAIN = 1.0  # seconds until a lost server is tried again
GONE = (404, 410)


def remote_job(question: Question) -> Callable[[Callable[[Progress], bool]], Solved]:
    """Return the work of having a server solve.

    A server that does not answer is tried again until it does or the work is cancelled;
    one that has forgotten the job, because it was started anew, gets it again.
    """

    def job(tell: Callable[[Progress], bool]) -> Solved:
        client = Client(question.server.url, question.server.key, retries=0, timeout=10.0)
        body = request_body(question)
        scale = CGCProblem.from_mesh(question.mesh).target_scale
        first: list[float] = []
        progress, sent = Progress(), False
        while True:
            try:
                if not sent:
                    client.request("POST", "/api/v1/jobs", body["bytes"])
                    sent = True
                status = client.poll(body["id"])
                if status["state"] == "succeeded":
                    return _solved(question, client.result(body["id"]))
                if status["state"] in ("failed", "cancelled"):
                    raise CGCError(status["message"] or f"the server says that the job is {status['state']}")
                error = status["error"]
                if error is not None:
                    first[:] = first or [error]
                    progress = Progress(status["iteration"], error, part_done(first[0], error, GOAL * scale))
                pause, told = LOOK, progress
            except ServerUnavailable as lost:
                pause, told = AGAIN, progress._replace(note=f"{lost}; trying again")
            except Refused as refusal:
                if refusal.status not in GONE or not sent:
                    raise CGCError(str(refusal)) from None
                sent, pause, told = False, LOOK, progress
            if tell(told):
                _cancel(client, body["id"])
                raise CGCError("cancelled")
            time.sleep(pause)

    return job


def request_body(question: Question) -> dict:
    """Return the ``bytes`` of a request and the ``id`` of its job, which stays the same when it is sent again."""
    mesh, id = question.mesh, uuid.uuid4().hex
    asked: dict[str, Any] = {"id": id, **_settings(question.settings)}
    if question.constraints:
        asked["constraints"] = [constraint_data(constraint) for constraint in question.constraints]
    if "dummy" in _column(mesh, "role") or any(value is not None for name in "se" for value in _column(mesh, name)):
        # Only COMPAS JSON holds these; it takes longer to write and to read.
        asked["mesh"] = {"dtype": "compas_cgc.datastructures/CGCMesh", "data": _plain(mesh)}
    else:
        index = {key: i for i, key in enumerate(mesh.vertices())}
        vertices, faces = mesh.arrays()
        asked.update(
            vertices=pack(vertices, "f8", 3),
            faces=pack(faces, "i4", 3),
            supports=[index[key] for key in mesh.supports()],
            creases=[[index[u], index[v]] for u, v in mesh.crease_edges()],
            targets=_column(mesh, "target"),
        )
    return {"id": id, "bytes": json.dumps(asked, allow_nan=False).encode("utf-8")}


def _column(mesh: CGCMesh, name: str) -> list:
    """Return an attribute of all vertices; COMPAS itself takes ten times as long."""
    default = mesh.default_vertex_attributes.get(name)
    return [attributes.get(name, default) for attributes in mesh.vertex.values()]


def _plain(mesh: CGCMesh) -> dict:
    """Return the data of a mesh with keys as JSON has them."""
    return json.loads(json.dumps(mesh.__data__))


def _settings(settings: Any) -> dict:
    if settings is None:
        return {}
    method = next(name for name, kind in SETTINGS.items() if isinstance(settings, kind))
    return {"method": method, "settings": {name: value for name, value in settings.to_dict().items() if value is not None}}


def _solved(question: Question, result: dict) -> Solved:
    mesh = question.mesh.with_coordinates(np.array(result["vertices"], dtype=np.float64))
    report = report_text(result["message"], mesh, question.mesh)
    return Solved(mesh, result["status"], result["message"], result["max_error"], result["seconds"], result["history"], report)


def _cancel(client: Client, id: str) -> None:
    try:
        client.cancel(id)
    except (ServerUnavailable, Refused):
        pass
