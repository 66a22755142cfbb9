"""The addresses that Hops and McNeel's compute clients call."""

from __future__ import annotations

import base64
import binascii
import json
from typing import Optional
from urllib.parse import urlsplit

from flask import Blueprint
from flask import Response
from flask import current_app
from flask import g
from flask import request

from ..arrays import read_json
from ..jobs import Jobs
from ..outcome import unpack
from ..task import TaskError
from ..task import TaskStopped
from ..task import WorkerDied
from ..problems import BadRequest
from ..problems import NotFound
from ..problems import RequestProblem
from ..problems import Unprocessable
from ..problems import error_body
from .catalogue import ENDPOINTS
from .functions import Reply
from .functions import run_function
from .functions import surface_values
from .values import entry
from .values import read_values

__all__ = ["hops"]

hops = Blueprint("hops", __name__)


class TooSlow(RequestProblem):
    """The client would give up soon."""

    status = 504


class Broken(RequestProblem):
    """A worker ended."""

    status = 500


@hops.get("/")
def functions() -> Response:
    """List the functions."""
    return _respond([endpoint.describe() for endpoint in ENDPOINTS.values()])


@hops.get("/cgc/<name>", strict_slashes=False)
@hops.get("/cgc/<name>/", strict_slashes=False)
def describe(name: str) -> Response:
    """Describe a function."""
    return _respond(ENDPOINTS[_known(f"cgc/{name}")].describe())


@hops.route("/io", methods=["GET", "POST"])
def io() -> Response:
    """Describe a function named in the request."""
    if request.method == "GET":
        return _respond(ENDPOINTS[_uri({"pointer": request.args.get("pointer")})].describe())
    return _respond(ENDPOINTS[_uri(_body())].describe())


@hops.post("/solve")
@hops.post("/grasshopper")
@hops.post("/<path:prefix>/solve")
def solve(prefix: str = "") -> Response:
    """Run a function."""
    body = _body()
    uri = _uri(body)
    values = body.get("values")
    context = {"modelunits": _units(body.get("modelunits")), "absolutetolerance": _tolerance(body.get("absolutetolerance"))}
    try:
        if uri == "cgc/submit":
            reply = _submit(values, context)
        elif uri == "cgc/fetch":
            reply = _fetch(values)
        else:
            reply = _run(uri, values, context)
    except RequestProblem as problem:
        reply = Reply(problem.status, [], [str(problem)], [], {})
    g.spent = reply.spent
    message = {"message": reply.errors[0]} if reply.errors else {}
    answer = {**message, "pointer": uri, "values": reply.values, "errors": reply.errors, "warnings": reply.warnings}
    return _respond(answer, reply.status)


def _run(uri: str, values: object, context: dict) -> Reply:
    gone = request.environ.get("waitress.client_disconnected", lambda: False)
    try:
        return _jobs().call(run_function, uri, values, context, client=request.remote_addr or "", gone=gone)
    except TimeoutError:
        seconds = current_app.config["LIMITS"].blocking
        raise TooSlow(f"the solve was stopped after {seconds:g} seconds; use /cgc/submit and /cgc/fetch for long ones") from None
    except (WorkerDied, TaskStopped) as error:
        raise Broken(str(error)) from None
    except TaskError as error:
        current_app.logger.error("%s failed: %s", uri, error.trace)
        raise Broken(f"the solver failed unexpectedly ({error.kind}); the log of the server says more") from None


def _submit(values: object, context: dict) -> Reply:
    read_values(ENDPOINTS["cgc/submit"], values)
    body = json.dumps({"values": values, "context": context}).encode()
    job, _ = _jobs().submit("hops", body, {"name": "Grasshopper"}, client=request.remote_addr or "")
    return Reply(200, [entry("Job", "Text", [job.id])], [], [], {})


def _fetch(values: object) -> Reply:
    inputs = read_values(ENDPOINTS["cgc/fetch"], values)
    job = _jobs().get(inputs["Job"])
    step, steps = job.progress.get("step", 0), job.progress.get("steps")
    if not job.over:
        told = f"{job.state}, step {step}, largest error {job.progress['max_error']:.3g}" if steps else job.state
        return _state(202, [], False, step / steps if steps else 0.0, told)
    if job.state != "succeeded":
        raise Unprocessable(f"the job was {job.state}: {job.message}" if job.state == "cancelled" else str(job.message))
    from ...problem import CGCProblem

    result, report = unpack(_jobs().result(job.id))
    problem = CGCProblem.from_mesh(result.mesh)
    mesh = surface_values(problem, problem.vertices, "", result.max_error)[0]
    reply = _state(200, [], True, 1.0, "\n".join([result.message, *report.get("notes", [])]))
    warnings = [] if result.converged else [result.message]
    return reply._replace(values=[mesh, *reply.values[1:]], warnings=warnings)


def _state(status: int, mesh: list, done: bool, progress: float, told: str) -> Reply:
    values = [
        entry("Mesh", "Mesh", mesh),
        entry("Done", "Boolean", [done]),
        entry("Progress", "Number", [round(progress, 4)]),
        entry("Info", "Text", [told]),
    ]
    return Reply(status, values, [], [], {})


def _jobs() -> Jobs:
    return current_app.extensions["jobs"]


def _body() -> dict:
    """Return the request, whatever its Content-Type; one enclosing list is allowed."""
    value = read_json(request.get_data(cache=False), current_app.config["LIMITS"])
    if isinstance(value, list) and len(value) == 1:
        value = value[0]
    if not isinstance(value, dict):
        raise BadRequest("the request must be a JSON object with 'pointer' and 'values'")
    return value


def _uri(body: dict) -> str:
    """Return the function that a request names; an address in it is taken apart, never followed."""
    pointer, algo = body.get("pointer"), body.get("algo")
    if pointer is None and isinstance(algo, str):
        try:
            pointer = base64.b64decode(algo[:400], validate=True).decode()
        except (binascii.Error, ValueError):
            pointer = None
    if not isinstance(pointer, str) or not pointer:
        raise NotFound(f"the request names no function; there are {', '.join(ENDPOINTS)}")
    return _known(_path(pointer))


def _path(pointer: str) -> str:
    try:
        return urlsplit(pointer).path if "://" in pointer else pointer.split("?")[0]
    except ValueError:
        return pointer


def _known(path: str) -> str:
    uri = path.strip("/").lower()
    if uri not in ENDPOINTS:
        raise NotFound(f"there is no function {uri[:60]!r}; there are {', '.join(ENDPOINTS)}")
    return uri


def _units(name: object) -> str:
    return name[:40] if isinstance(name, str) else ""


def _tolerance(value: object) -> float:
    good = isinstance(value, (int, float)) and not isinstance(value, bool) and 0 < value < 1e12
    return float(value) if good else 0.0


def _respond(body: object, status: int = 200, headers: Optional[dict] = None) -> Response:
    if status != 200 and isinstance(body, dict) and body.get("errors"):
        body = {**error_body(body["errors"][0]), **body}
    return Response(json.dumps(body, ensure_ascii=False, allow_nan=False), status, headers, mimetype="application/json")
