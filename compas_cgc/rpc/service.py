"""RPC service for :class:`compas.rpc.Proxy`, restricted to this machine and to the functions below.

From Rhino or Grasshopper, `python` must be the path of a Python with compas_cgc::

    from compas.rpc import Proxy

    proxy = Proxy(
        service="compas_cgc.rpc.service", python="/path/to/python", port=7332, autoreload=False, capture_output=False
    )
    id = proxy.submit(mesh, supports="boundary", targets=0.01)
    proxy.status(id)["state"]
    proxy.result(id)["mesh"]

Reasons for these arguments: the default port of Proxy, 1753, may be used by the service of another
package, which Proxy does not notice (check with ``version()``); ``autoreload`` has no effect; with
``capture_output``, the output of the service is not visible. The other defaults of Proxy work.
"""

from __future__ import annotations

import argparse
import base64
import binascii
import functools
import hmac
import inspect
import json
import logging
import os
import signal
import sys
from collections.abc import Sequence
from socketserver import ThreadingMixIn
from typing import Any
from typing import Callable
from typing import Optional
from xmlrpc.client import Fault
from xmlrpc.server import SimpleXMLRPCRequestHandler

from compas.rpc import Server

from .._version import __version__
from .._warm_up import warm_up
from ..execution.pool import WorkerPool
from ..server.api.decoding import read_json
from ..server.api.formats import encoded
from ..server.api.job_status import status
from ..server.api.requests import accept
from ..server.api.tasks import solve_job
from ..server.errors import RequestError
from ..server.jobs.engine import Jobs
from ..server.jobs.store import Store
from ..server.limits import Limits

__all__ = ["Service", "main", "start_service"]

PORT = 7332
LIMITS = Limits(days=1.0)  # jobs are in memory and expire after a day
LOOPBACK = ("127.0.0.1", "localhost", "[::1]")

log = logging.getLogger(__name__)


class Service:
    """The functions of the service.

    Parameters
    ----------
    jobs
        Engine that runs the solves.
    """

    def __init__(self, jobs: Jobs):
        self._jobs = jobs
        self._given: dict[str, Optional[str]] = {}
        self._functions: dict[str, Callable] = {
            name: getattr(self, name) for name in ("version", "solve", "submit", "status", "result", "cancel")
        }

    def version(self) -> dict:
        """Return name and version of the service."""
        return {"name": "compas_cgc", "version": __version__}

    def submit(self, mesh: Optional[dict] = None, **options: object) -> str:
        """Submit a solve and return the id of its job.

        Parameters
        ----------
        mesh
            A COMPAS mesh; a ``CGCMesh`` includes supports, creases and targets.
        options
            ``supports``, ``creases``, ``targets``, ``method``, ``settings``, ``flip``; ``vertices`` and ``faces``
            instead of a mesh.
        """
        request = {**options, **({} if mesh is None else {"mesh": mesh})}
        job, _ = self._jobs.submit("json", accept(request, self._jobs.limits))
        for id in list(self._given):
            # Expired jobs.
            if self._jobs.store.get(id) is None:
                self._given.pop(id, None)
        self._given[job.id] = None if mesh is None else mesh["dtype"]
        return job.id

    def status(self, id: str) -> dict:
        """Return state, progress, step and error of a job."""
        return status(self._jobs.get(id))

    def result(self, id: str) -> dict:
        """Return the result of a job: its mesh in the form of the input (a COMPAS mesh, or vertices and faces), with the report."""
        content = self._jobs.result(id)
        answer = json.loads(encoded("arrays", content))
        kind = self._given.get(id)
        if kind is None:
            return answer
        # A client without compas_cgc could not read a CGCMesh.
        mesh = {**json.loads(encoded("compas", content)), "dtype": kind}
        kept = ("status", "message", "method", "iterations", "seconds", "max_error", "curvature", "report")
        return {"mesh": mesh, **{name: answer[name] for name in kept}}

    def cancel(self, id: str) -> dict:
        """Stop a job and return its status."""
        return status(self._jobs.cancel(id))

    def solve(self, mesh: Optional[dict] = None, **options: object) -> dict:
        """Solve and wait for the result; see :meth:`submit` and :meth:`result`."""
        id = self.submit(mesh, **options)
        for _ in self._jobs.follow(id):
            pass
        return self.result(id)

    def _dispatch(self, name: str, args: Sequence[object]) -> str:
        """Answer a call of Proxy with JSON input and output; further arguments, such as an import path, are ignored."""
        try:
            if name not in self._functions:
                raise RequestError(f"not part of the API: {name[:60]}; the functions are {', '.join(self._functions)}")
            call = read_json(str(args[0]).encode(), self._jobs.limits) if args else None
            if not isinstance(call, dict) or not isinstance(call.get("args"), list) or not isinstance(call.get("kwargs"), dict):
                raise RequestError("a call must be a JSON object with 'args' and 'kwargs', as sent by compas.rpc.Proxy")
            data, error = _bound(name, self._functions[name], call["args"], call["kwargs"])(), None
        except RequestError as refused:
            data, error = None, str(refused)
        except Exception:
            log.exception("%s failed", name)
            data, error = None, "the call failed because of an error in the service; see its log"
        return json.dumps({"data": data, "error": error, "profile": None})


def _bound(name: str, function: Callable, args: list, options: dict) -> Callable[[], object]:
    """Return a function with the arguments of a call.

    Raises
    ------
    RequestError
        If the arguments do not match the function.
    """
    try:
        given = inspect.signature(function).bind(*args, **options)
    except TypeError as error:
        raise RequestError(f"{name} cannot be called with these arguments: {error}") from None
    id = given.arguments.get("id")
    if "id" in given.arguments and not isinstance(id, str):
        raise RequestError(f"the id of a job must be a string, as submit returns it, not {json.dumps(id)[:40]}")
    return functools.partial(function, *given.args, **given.kwargs)


class Handler(SimpleXMLRPCRequestHandler):
    """Request handler that rejects requests from web pages and too large requests."""

    rpc_paths = ("/", "/RPC2")
    timeout = 30.0  # time without data after which a connection is closed [s]

    def do_POST(self) -> None:  # noqa: N802
        """Answer a call."""
        host = self.headers.get("Host", "").rpartition(":")[0] or self.headers.get("Host", "")
        length = self.headers.get("Content-Length", "")
        if host not in LOOPBACK or self.headers.get("Origin") is not None:
            self.send_error(403)
        elif not length.isdecimal() or int(length) > LIMITS.body:
            self.send_error(413)
        else:
            super().do_POST()

    def _dispatch(self, method: str, arguments: tuple) -> object:
        """Answer a call; only the operator may stop the service."""
        if method == "remote_shutdown" and not self._is_operator():
            raise Fault(1, "remote_shutdown requires the key of the service (COMPAS_CGC_KEY): Proxy(url='http://operator:KEY@127.0.0.1')")
        server: Any = self.server
        return server._dispatch(method, arguments)

    def _is_operator(self) -> bool:
        """Check whether the password of the address is the key of the service; a service without a key has no operator."""
        scheme, _, coded = self.headers.get("Authorization", "").partition(" ")
        try:
            given = base64.b64decode(coded, validate=True).partition(b":")[2]
        except binascii.Error:
            return False
        return any(hmac.compare_digest(given, key.encode()) for key in os.environ.get("COMPAS_CGC_KEY", "").split()) and scheme == "Basic"


class RPCServer(ThreadingMixIn, Server):
    """A server that remains responsive during a solve."""

    daemon_threads = True

    def __init__(self, address: tuple[str, int]):
        Server.__init__(self, address, requestHandler=Handler, logRequests=False)


def start_service(port: int = PORT, workers: Optional[int] = None) -> None:
    """Run the service on this machine until it is interrupted."""
    limits = LIMITS
    # Bind the address first, so that a second service ends immediately.
    server = RPCServer(("127.0.0.1", port))
    pool = WorkerPool(workers or max(1, (os.cpu_count() or 2) - 1), warm_up, limits.grace)
    jobs = Jobs(pool, Store(":memory:"), solve_job, limits)
    server.register_instance(Service(jobs))
    print(f"compas_cgc {__version__} serves compas.rpc at http://127.0.0.1:{server.server_address[1]}; Ctrl-C ends it", flush=True)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        pass
    finally:
        server.server_close()
        jobs.close()


def main(argv: Optional[Sequence[str]] = None) -> int:
    """Run the service with the command-line arguments of Proxy."""
    parser = argparse.ArgumentParser(prog="python -m compas_cgc.rpc.service", description="Serve compas.rpc on this machine.")
    parser.add_argument("--port", type=int, default=PORT, help=f"port (default {PORT})")
    parser.add_argument("--workers", type=int, help="number of simultaneous solves")
    for name in ("--autoreload", "--no-autoreload"):
        parser.add_argument(name, action="store_true", help="accepted for compatibility with Proxy; no effect")
    arguments = parser.parse_args(argv)
    try:
        start_service(arguments.port, arguments.workers)
    except OSError as error:
        print(f"port {arguments.port} cannot be used ({error.strerror}); choose another with --port", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
