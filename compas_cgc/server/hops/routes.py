"""Routes for Hops and Rhino.Compute clients."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import Optional

from flask import Blueprint
from flask import Response
from flask import current_app
from flask import g
from flask import request
from flask.blueprints import BlueprintSetupState

from ..api.blocking_calls import jobs
from ..api.blocking_calls import run_in_worker
from ..api.decoding import check_length
from ..api.decoding import is_light
from ..api.responses import respond
from ..api.serialization import unpack_result
from ..errors import RequestError
from ..errors import TooLarge
from ..errors import Unprocessable
from ..errors import error_body
from ..limits import Limits
from ..security import client_name
from ..security import owner
from .cache import Answers
from .cache import request_digest
from .data_tree import entry
from .data_tree import passed_over
from .endpoints import REPEATABLE
from .endpoints import endpoint
from .endpoints import endpoints
from .functions import run_function
from .functions import surface_values
from .large_requests import Answered
from .large_requests import job_asked_for
from .large_requests import job_body
from .large_requests import run_request_body
from .protocol import context_of
from .protocol import known
from .protocol import read_body
from .protocol import uri_of
from .reply import Reply

__all__ = ["hops", "list_functions"]

CACHE_SIZE = 64 * 2**20  # size of the response cache [bytes]
HINT = "use /cgc/submit and /cgc/fetch for long solves"

hops = Blueprint("hops", __name__)


@hops.record
def _set_up(state: BlueprintSetupState) -> None:
    state.app.extensions["hops_answers"] = Answers(CACHE_SIZE)


def list_functions() -> Response:
    """Describe all functions."""
    return respond([own.describe() for own in endpoints().values()])


@hops.get("/cgc/<name>", strict_slashes=False)
@hops.get("/cgc/<name>/", strict_slashes=False)
def describe(name: str) -> Response:
    """Describe a function."""
    return respond(endpoint(known(f"cgc/{name}")).describe())


@hops.route("/io", methods=["GET", "POST"])
def io() -> Response:
    """Describe a function named in the request."""
    if request.method != "POST":
        return respond(endpoint(uri_of({"pointer": request.args.get("pointer")})).describe())
    return respond(endpoint(uri_of(_body())).describe())


@hops.post("/solve")
@hops.post("/grasshopper")
@hops.post("/<path:prefix>/solve")
def solve(prefix: str = "") -> Response:
    """Run a function."""
    content, limits = _content()
    return _solved_here(read_body(content, limits), limits) if is_light(content, limits) else _solved_there(content, limits)


def _solved_here(body: dict, limits: Limits) -> Response:
    """Return the response to a parsed request."""
    uri = uri_of(body)
    values = body.get("values")
    context = context_of(body)
    digest = request_digest(owner(), uri, values, context) if body.get("cachesolve") is True and uri in REPEATABLE else None
    kept = _kept(digest)
    if kept is not None:
        return kept
    try:
        if uri == "cgc/submit":
            reply = _submitted(job_body(values, context), passed_over(endpoint(uri), values))
        elif uri == "cgc/fetch":
            reply = _fetched(job_asked_for(values), passed_over(endpoint(uri), values))
        else:
            reply = run_in_worker(run_function, uri, values, context, limits, hint=HINT, alike=uri)
    except RequestError as error:
        reply = Reply(error.status, [], [str(error)], [], {})
    return _answer(uri, reply, digest)


def _solved_there(content: bytes, limits: Limits) -> Response:
    """Return the response to a request that the worker parses; the cache identifies it by its bytes."""
    digest = hashlib.sha256(owner().encode() + b"\n" + content).digest()
    kept = _kept(digest)
    if kept is not None:
        return kept
    done: Answered = run_in_worker(run_request_body, content, limits, hint=HINT, alike="large requests")
    try:
        reply = done.reply or (_fetched(done.id, done.warnings) if done.job is None else _submitted(done.job, done.warnings))
    except RequestError as error:
        reply = Reply(error.status, [], [str(error)], [], {})
    return _answer(done.uri, reply, digest if done.kept else None)


def _kept(digest: Optional[bytes]) -> Optional[Response]:
    """Return the cached response to the same request, None if there is none."""
    kept = _answers().get(digest) if digest else None
    return None if kept is None else Response(kept, 200, {"Server-Timing": "cache;desc=hit"}, mimetype="application/json")


def _answer(uri: str, reply: Reply, digest: Optional[bytes]) -> Response:
    g.spent = reply.spent
    message = reply.errors[0] if reply.errors else ""
    answer = {"message": message, "pointer": uri, "values": reply.values, "errors": reply.errors, "warnings": reply.warnings}
    response = respond(answer if reply.status == 200 or not reply.errors else {**error_body(message), **answer}, reply.status)
    if digest and reply.status == 200:
        _answers().put(digest, response.get_data())
    return response


def _answers() -> Answers:
    return current_app.extensions["hops_answers"]


def _submitted(body: bytes, warnings: Sequence[str]) -> Reply:
    job, _ = jobs().submit("hops", body, {"name": "Grasshopper"}, client=client_name())
    return Reply(200, [entry("Job", "Text", [job.id])], [], list(warnings), {})


def _fetched(id: str, warnings: Sequence[str]) -> Reply:
    reply = _fetch(id)
    return reply._replace(warnings=[*reply.warnings, *warnings])


def _fetch(id: str) -> Reply:
    job = jobs().get(id)
    step, steps = job.progress.get("step", 0), job.progress.get("steps")
    if not job.over:
        error = job.progress.get("max_error")
        text = job.state + (f", step {step}" if steps else "") + (f", largest error {error:.3g}" if error is not None else "")
        return _state(202, [], False, step / steps if steps else 0.0, text)
    if job.state != "succeeded":
        raise Unprocessable(f"the job was {job.state}: {job.message}" if job.state == "cancelled" else str(job.message))
    result, report = unpack_result(jobs().result(job.id))
    mesh = surface_values(result, "")[0]
    reply = _state(200, [], True, 1.0, "\n".join([result.message, *report["notes"]]))
    # A rough surface is the first of the notes.
    warnings = report["notes"][:1] if result.converged and not report["verdict"]["fair"] else [] if result.converged else [result.message]
    return reply._replace(values=[mesh, *reply.values[1:]], warnings=warnings)


def _state(status: int, mesh: list, done: bool, progress: float, text: str) -> Reply:
    values = [
        entry("Mesh", "Mesh", mesh),
        entry("Done", "Boolean", [done]),
        entry("Progress", "Number", [round(progress, 4)]),
        entry("Info", "Text", [text]),
    ]
    return Reply(status, values, [], [], {})


def _body() -> dict:
    """Return a small request that only names a function."""
    content, limits = _content()
    if not is_light(content, limits):
        raise TooLarge("the request must only name a function, but is too large")
    return read_body(content, limits)


def _content() -> tuple[bytes, Limits]:
    """Return the bytes of the request after checking their number, and the limits."""
    limits: Limits = current_app.config["LIMITS"]
    check_length(request.content_length, limits)
    return request.get_data(cache=False), limits
