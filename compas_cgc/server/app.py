"""Flask application: assembly of the server and its error responses."""

from __future__ import annotations

import logging
import os
import secrets
import sqlite3
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from threading import BoundedSemaphore
from typing import Optional
from typing import Union

from flask import Flask
from flask import Response
from flask import current_app
from flask import g
from flask import request
from werkzeug.exceptions import HTTPException

from ..errors import sentence_of
from ..execution.pool import WorkerPool
from ..execution.protocol import AnyExecutor
from .api.designs import designs
from .api.mesh_files import warm_up_io
from .api.remedies import remedies_in
from .api.requests import READERS
from .api.responses import respond
from .api.routes import api
from .api.tasks import solve_job
from .api.warm_up import warm_up_writer
from .errors import RequestError
from .errors import UnsupportedEncoding
from .errors import error_body
from .errors import no_function
from .hops.inputs import read_hops_request
from .hops.routes import hops
from .hops.routes import list_functions
from .hops.warm_up import warm_up
from .jobs.engine import Jobs
from .jobs.shares import ByteBudget
from .jobs.store import Store
from .keys import Keys
from .keys import Throttle
from .limits import Limits
from .operation.logs import begin_request
from .operation.logs import log_request
from .operation.logs import request_id
from .operation.metrics import Metrics
from .operation.readiness import Readiness
from .operation.routes import operation
from .page import index
from .page import page
from .page import wants_page
from .security import guard

__all__ = ["create_app"]

log = logging.getLogger(__name__)

# Niceness of processes whose solves may be long. Those of short calls and of files get three times as much of a shared processor.
LONG_NICENESS = 5
PRELOAD = "compas_cgc.server.preload"
SENTENCES = {
    404: "there is nothing at this address; GET /openapi.json lists the available addresses",
    405: "this address does not support {method} requests; GET /openapi.json lists the available addresses",
    413: "the request is larger than the server accepts; use a coarser mesh",
}


def create_app(
    store: Union[str, Path] = ":memory:",
    key: Union[str, Sequence[str], Keys, None] = None,
    workers: Optional[int] = None,
    limits: Optional[Limits] = None,
    hosts: tuple[str, ...] = (),
    executor: Optional[AnyExecutor] = None,
) -> Flask:
    """Create the application and start its workers; ``app.extensions["jobs"].close()`` ends them.

    Parameters
    ----------
    store
        SQLite file that stores the jobs, or ``":memory:"``.
    key
        Key that clients must send with every request, or several keys. Each key counts as one client,
        whatever its address. Default: no key.
    workers
        Number of worker processes for all solves. Default: one less than the number of processors, at least
        one. Further workers run blocking calls only, see ``reserved`` of the limits.
    limits
        Limits on the size and number of requests.
    hosts
        Host names under which clients reach the server, besides those of the local machine.
    executor
        Executor of the solves instead of worker processes, see :mod:`compas_cgc.execution.protocol`. Any
        :class:`concurrent.futures.Executor` is accepted, but its jobs report no progress and cannot be stopped.

    Returns
    -------
    flask.Flask
        A WSGI application.

    Examples
    --------
    >>> from compas_cgc.server import create_app
    >>> app = create_app(":memory:", workers=1)  # doctest: +SKIP
    """
    limits = limits or Limits()
    keys = key if isinstance(key, Keys) else Keys(key)
    app = Flask("compas_cgc.server", static_folder=None)
    app.config.update(MAX_CONTENT_LENGTH=limits.body, LIMITS=limits, KEYS=keys, HOSTS=frozenset(hosts), INSTANCE=secrets.token_hex(8))
    # First, as opening the store can fail.
    stored = Store(store)
    count = workers or max(1, (os.cpu_count() or 2) - 1)
    pool = executor or WorkerPool(count, warm_up, limits.grace, limits.reserved, LONG_NICENESS, PRELOAD)
    readers, writers = (WorkerPool(1, own, limits.grace, preload=PRELOAD) for own in (warm_up_io, warm_up_writer))
    solve = partial(solve_job, readers={**READERS, "hops": read_hops_request})
    jobs = app.extensions["jobs"] = Jobs(pool, stored, solve, limits, readers, writers)
    app.extensions["readiness"] = Readiness(jobs.problems)
    app.extensions["metrics"] = Metrics(jobs)
    app.extensions["bodies"] = ByteBudget(limits.bodies, limits.blocking, limits.light, limits.conversions)
    app.extensions["throttle"] = Throttle()
    app.extensions["wait_slots"] = BoundedSemaphore(limits.streams)
    app.before_request(begin_request)
    app.before_request(guard)
    app.before_request(_refuse_compressed)
    app.after_request(_finish)
    app.register_error_handler(RequestError, _refused)
    app.register_error_handler(HTTPException, _http_error)
    app.register_error_handler(sqlite3.DatabaseError, _no_room)
    app.register_error_handler(Exception, _bug)
    app.register_blueprint(api)
    app.register_blueprint(designs)
    app.register_blueprint(hops)
    app.register_blueprint(page)
    app.register_blueprint(operation)
    app.add_url_rule("/", view_func=_root)
    return app


def _root() -> Response:
    """Return the page to a browser, and the list of functions to other clients."""
    response = index() if wants_page() else list_functions()
    response.vary.add("Accept")
    return response


def _refuse_compressed() -> None:
    encoding = request.headers.get("Content-Encoding", "identity")
    if encoding.lower() not in ("", "identity"):
        raise UnsupportedEncoding(f"the request is compressed ({encoding:.40}), which this server does not support; send it uncompressed")


def _finish(response: Response) -> Response:
    seconds = log_request(response)
    address = "none" if request.url_rule is None else request.url_rule.rule
    current_app.extensions["metrics"].count(request.method, address, response.status_code, seconds)
    response.headers["X-Content-Type-Options"] = "nosniff"
    response.headers.setdefault("Cache-Control", "no-store")
    response.headers.setdefault("Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'")
    spent = g.get("spent")
    if spent:
        response.headers["Server-Timing"] = ", ".join(f"{name};dur={1000 * seconds:.1f}" for name, seconds in spent.items())
    return response


def _refused(error: RequestError) -> Response:
    return _error(sentence_of(error), error.status, error.headers)


def _http_error(error: HTTPException) -> Response:
    code = error.code or 500
    sentence = SENTENCES.get(code, (error.description or error.name)[:200]).format(method=request.method)
    methods = getattr(error, "valid_methods", None)
    allowed = {"Allow": ", ".join(sorted(methods))} if methods else None
    return _error(sentence, code, allowed)


def _no_room(error: sqlite3.DatabaseError) -> Response:
    log.error("%s %s failed: %s", request.method, request.path, error)
    return _error("the server cannot store jobs at the moment, probably because its disk is full; free disk space and try again", 507)


def _bug(error: Exception) -> Response:
    log.exception("%s %s failed", request.method, request.path)
    return _error(f"the request failed because of an error in the server; see the request {request_id()} in its log", 500)


def _error(message: str, status: int, headers: Optional[dict] = None) -> Response:
    # Hops takes every path for that of a function.
    asks_for_function = request.method in ("GET", "HEAD") and not request.path.startswith("/api/")
    more = {"remedies": found} if (found := remedies_in([message])) else {}
    return respond(error_body(message, **more, **(no_function(message) if asks_for_function else {})), status, headers)
