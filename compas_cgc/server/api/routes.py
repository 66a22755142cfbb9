"""Routes of the job API, version and the OpenAPI description."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from collections.abc import Mapping
from contextlib import suppress
from threading import BoundedSemaphore
from typing import Any
from typing import Optional

import numpy as np
from flask import Blueprint
from flask import Response
from flask import current_app
from flask import g
from flask import request
from flask import url_for

from ..._version import __version__
from ..errors import BadRequest
from ..errors import Busy
from ..errors import RequestError
from ..errors import Unprocessable
from ..jobs.store import Job
from ..security import client_name
from .blocking_calls import jobs
from .blocking_calls import run_in_reader
from .blocking_calls import run_in_worker
from .blocking_calls import run_in_writer
from .builds import is_build
from .builds import tasks
from .decoding import check_length
from .decoding import is_light
from .decoding import packed
from .design_files import DESIGN_KINDS
from .formats import FORMATS
from .formats import SHOWN
from .formats import encoded
from .formats import merged_into
from .formats import moved
from .job_status import status
from .mesh_files import KINDS
from .methods import methods
from .moulds import MOULD_FORMATS
from .moulds import moulds_of
from .moulds import read_mould_options
from .openapi import description
from .responses import respond
from .schemas import PAGE
from .schemas import STATES
from .submissions import file_submission
from .submissions import json_submission
from .submissions import with_result
from .uploads import body_held

__all__ = ["api"]

api = Blueprint("api", __name__)
LONGEST_WAIT = 25.0  # seconds
LONGEST_LEAVE = 3600.0  # seconds
SMALL = 2**19  # size of a result encoded in this process instead of a worker [bytes]; about 4,000 vertices
SMALL_PACKED = 2**21  # the same for packed arrays; about 14,000 vertices


@api.get("/version")
def version() -> Response:
    """Return the name and version of the program."""
    return respond({"name": "compas_cgc", "version": __version__, "api": 1, "instance": current_app.config["INSTANCE"]})


@api.get("/openapi.json")
def openapi() -> Response:
    """Return the OpenAPI description of the job API."""
    return respond(description())


@api.get("/api/v1/methods")
def list_methods() -> Response:
    """List the methods with their options."""
    return respond({"methods": methods()})


@api.get("/api/v1/tasks")
def list_tasks() -> Response:
    """List the tasks on solved surfaces and their options."""
    return respond({"tasks": tasks()})


@api.post("/api/v1/jobs")
def submit() -> Response:
    """Accept a job."""
    started = time.perf_counter()
    limits = current_app.config["LIMITS"]
    kind, follow = request.args.get("kind", "json"), request.args.get("follow")
    if follow not in (None, "true"):
        raise Unprocessable("'follow' can only be true; the response is then a stream of events")
    if kind == "json":
        check_length(request.content_length, limits)
    if kind == "json":
        with body_held() as body:
            read = json_submission(body, limits) if is_light(body, limits) else run_in_reader(json_submission, body, limits)
            given = with_result(read, jobs().result)
            g.spent = {"check": time.perf_counter() - started}
            job, _ = jobs().submit(given.kind, given.body, given.options, given.id, client_name())
    elif kind in KINDS or kind in DESIGN_KINDS:
        length = request.content_length or 0
        given = file_submission(kind, length, request.args.get("options", "{}"), limits)
        # The file goes from the connection to the disk in pieces; few at a time, as they share the disk.
        with current_app.extensions["bodies"].held(length, client_name()):
            job, _ = jobs().submit(given.kind, request.stream, given.options, given.id, client_name())
    else:
        raise Unprocessable(f"'kind' must be json, {' or '.join(KINDS)}; or for the task rationalise {', '.join(DESIGN_KINDS)}")
    # If all slots are taken, respond at once; the client polls.
    if follow and _wait_slots().acquire(blocking=False):
        return _stream(job.id, with_surface="task" not in given.options)
    address = url_for("api.show", id=job.id)
    links = {"id": job.id, "state": job.state, "status_url": address, "events_url": f"{address}/events", "result_url": f"{address}/result"}
    return respond(links, 202, {"Location": address})


@api.get("/api/v1/jobs")
def show_all() -> Response:
    """List the jobs page by page, newest first."""
    limit, offset, state = _page(request.args)
    found, total = jobs().page(limit, offset, state)
    positions = jobs().positions()
    listed = [status(job, positions.get(job.id)) for job in found]
    return respond({"jobs": listed, "total": total, "limit": limit, "offset": offset})


def _page(given: Mapping[str, str]) -> tuple[int, int, Optional[str]]:
    """Return limit, offset and state of the requested page."""
    unknown = sorted(set(given) - set(PAGE))
    if unknown:
        raise Unprocessable(f"unknown parameter {unknown[0]!r:.60}; the parameters are {', '.join(PAGE)}")
    state = given.get("state")
    if state is not None and state not in STATES:
        raise Unprocessable(f"'state' must be one of {', '.join(STATES)}")
    return _bounded(given, "limit"), _bounded(given, "offset"), state


def _bounded(given: Mapping[str, str], name: str) -> int:
    schema: Any = PAGE[name]
    text = given.get(name, str(schema["default"]))
    low, high = schema["minimum"], schema["maximum"]
    if not (text.isascii() and text.isdecimal() and len(text) < 12 and low <= int(text) <= high):
        raise Unprocessable(f"'{name}' must be an integer from {low} to {high}")
    return int(text)


def _status(job: Job) -> dict:
    return status(job, jobs().positions().get(job.id))


@api.get("/api/v1/jobs/<id>")
def show(id: str) -> Response:
    """Return the status of a job; with ``wait``, when it is finished or after that time [s]."""
    seconds = min(request.args.get("wait", 0.0, type=float), LONGEST_WAIT)
    # If all slots are taken, respond at once; the client polls.
    if seconds > 0 and _wait_slots().acquire(blocking=False):
        try:
            return respond(_status(jobs().wait(id, seconds)))
        finally:
            _wait_slots().release()
    return respond(_status(jobs().get(id)))


@api.get("/api/v1/jobs/<id>/result")
def result(id: str) -> Response:
    """Return the result of a job in one of the formats."""
    name = request.args.get("format", "arrays")
    if name not in FORMATS:
        raise Unprocessable(f"'format' must be one of {', '.join(FORMATS)}")
    content = jobs().result(id)
    started = time.perf_counter()
    # Small results are encoded here, as the transfer to a worker would take longer.
    small = is_build(content) or (name not in KINDS and len(content) < (SMALL_PACKED if name == "packed" else SMALL))
    answer = Response(encoded(name, content) if small else run_in_writer(encoded, name, content), mimetype=FORMATS[name])
    if name not in SHOWN:
        answer.headers["Content-Disposition"] = f'attachment; filename="result.{name}"'
    g.spent = {"encode": time.perf_counter() - started}
    return answer


@api.get("/api/v1/jobs/<id>/moulds")
def moulds(id: str) -> Response:
    """Return the panels of the result of a job and their moulds."""
    kind = request.args.get("format", "json")
    if kind not in MOULD_FORMATS:
        raise Unprocessable(f"'format' must be one of {', '.join(MOULD_FORMATS)}")
    options = read_mould_options(request.args)
    content = run_in_worker(moulds_of, jobs().result(id), options, kind, hint="request fewer panels, or use a coarser mesh", alike="moulds")
    answer = Response(content, mimetype=MOULD_FORMATS[kind])
    if kind == "3dm":
        answer.headers["Content-Disposition"] = 'attachment; filename="moulds.3dm"'
    return answer


@api.post("/api/v1/jobs/<id>/result")
def merged_result(id: str) -> Response:
    """Return the uploaded .3dm file with the result of a job merged into it."""
    if request.args.get("format", "3dm") != "3dm":
        raise Unprocessable("'format' must be 3dm, the only format with content besides the mesh")
    with body_held() as source:
        if not source:
            raise BadRequest("the request is empty; send the bytes of the .3dm file")
        content = run_in_reader(merged_into, source, jobs().result(id))
    return Response(content, mimetype=KINDS["3dm"], headers={"Content-Disposition": 'attachment; filename="result.3dm"'})


@api.get("/api/v1/jobs/<id>/surface")
def surface(id: str) -> Response:
    """Return the current vertices of a running live job as little-endian float32."""
    content = jobs().surface(id)
    if content is None:
        # Not started, finished or not live: not an error of the client.
        return Response(status=204)
    return Response(content, mimetype="application/octet-stream")


@api.post("/api/v1/jobs/<id>/cancel")
def cancel(id: str) -> Response:
    """Stop a job."""
    return respond(_status(jobs().cancel(id)))


@api.delete("/api/v1/jobs/<id>")
def delete(id: str) -> Response:
    """Stop a job and delete it; with ``after``, unless it is requested again within that time [s]."""
    jobs().delete(id, min(request.args.get("after", 0.0, type=float), LONGEST_LEAVE))
    return Response(status=204)


@api.get("/api/v1/jobs/<id>/events")
def events(id: str) -> Response:
    """Stream the status of a job whenever it changes."""
    jobs().get(id)
    if not _wait_slots().acquire(blocking=False):
        raise Busy("too many event streams are open; request the status of the job instead")
    return _stream(id)


def _stream(id: str, with_surface: bool = False) -> Response:
    """Stream the status of a job and, if requested, its final surface. The caller has reserved a slot."""
    engine = jobs()

    def stream() -> Iterator[bytes]:
        shown = judged = None
        for job in engine.follow(id):
            if job is None:
                yield b": still here\n\n"
                continue
            kind = {"succeeded": "done", "failed": "failed", "cancelled": "failed"}.get(job.state, "progress")
            state = status(job, engine.positions().get(id))
            yield _event(kind, state)
            arrived = engine.arrived(id) if with_surface else None
            if arrived is not None and arrived is not shown:
                shown = arrived
                yield _event("surface", {"vertices": packed(np.frombuffer(arrived).reshape(-1, 3))})
            said = engine.judged(id) if with_surface else None
            if said is not None and said is not judged:
                judged = said
                yield _event("verdict", said)
            if with_surface and state["has_result"]:
                # If the result was deleted meanwhile, the client's request for it is answered with an error.
                with suppress(RequestError):
                    yield b"event: result\ndata: " + moved(engine.result(id)) + b"\n\n"

    # A proxy such as nginx would otherwise collect the events.
    answer = Response(stream(), mimetype="text/event-stream", headers={"X-Accel-Buffering": "no"})
    # Called at the end, even if the stream was never started.
    answer.call_on_close(_wait_slots().release)
    return answer


def _event(kind: str, data: dict) -> bytes:
    """Return an event in the format of the stream."""
    return f"event: {kind}\ndata: {json.dumps(data, ensure_ascii=False)}\n\n".encode()


def _wait_slots() -> BoundedSemaphore:
    """Return the semaphore that limits the requests holding a thread while they wait for a job."""
    return current_app.extensions["wait_slots"]
