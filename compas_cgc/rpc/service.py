"""RPC service for :class:`compas.rpc.Proxy`: this machine only, and nothing but the functions below.

From Rhino or Grasshopper, where `python` must be the Python that has compas_cgc::

    from compas.rpc import Proxy

    proxy = Proxy(
        service="compas_cgc.rpc.service", python="/path/to/python", port=7332, autoreload=False, capture_output=False
    )
    id = proxy.submit(mesh, supports="boundary", targets=0.01)
    proxy.status(id)["state"]
    proxy.result(id)["mesh"]

Why these arguments: Proxy's default port, 1753, may be taken by another package's service,
which Proxy would not notice (call ``version()`` to be sure); ``autoreload`` is accepted and
does nothing; with ``capture_output`` nobody can read what the service says. Proxy's other
defaults work.
"""

from __future__ import annotations

import argparse
import functools
import inspect
import json
import logging
import os
import signal
import sys
from collections.abc import Sequence
from socketserver import ThreadingMixIn
from typing import Callable
from typing import Optional
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
LOOPBACK = ("127.0.0.1", "localhost", "[::1]")

log = logging.getLogger(__name__)


class Service:
    """The functions of the service.

    Parameters
    ----------
    jobs
        Runs the solves.
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
        """Hand in a solve and return its id.

        Parameters
        ----------
        mesh
            A COMPAS mesh; a ``CGCMesh`` brings supports, creases and targets.
        options
            ``supports``, ``creases``, ``targets``, ``method``, ``settings``, ``flip``; ``vertices`` and ``faces``
            instead of a mesh.
        """
        request = {**options, **({} if mesh is None else {"mesh": mesh})}
        job, _ = self._jobs.submit("json", accept(request, self._jobs.limits))
        self._given[job.id] = None if mesh is None else mesh["dtype"]
        return job.id

    def status(self, id: str) -> dict:
        """Return state, progress, step and error of a job."""
        return status(self._jobs.get(id))

    def result(self, id: str) -> dict:
        """Return the result of a job: its mesh as it was given (a COMPAS mesh, or vertices and faces), with the report."""
        content = self._jobs.result(id)
        answer = json.loads(encoded("arrays", content))
        kind = self._given.get(id)
        if kind is None:
            return answer
        # A client with COMPAS alone could not read a CGCMesh.
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
        """Answer a call of Proxy: JSON in and out; what follows the first argument, a path to import from, is left alone."""
        try:
            if name not in self._functions:
                raise RequestError(f"not part of the API: {name[:60]}; there are {', '.join(self._functions)}")
            call = read_json(str(args[0]).encode(), self._jobs.limits) if args else None
            if not isinstance(call, dict) or not isinstance(call.get("args"), list) or not isinstance(call.get("kwargs"), dict):
                raise RequestError("a call must be a JSON object with 'args' and 'kwargs', as compas.rpc.Proxy makes it")
            data, error = _bound(name, self._functions[name], call["args"], call["kwargs"])(), None
        except RequestError as refused:
            data, error = None, str(refused)
        except Exception:
            log.exception("%s failed", name)
            data, error = None, "the service has a fault and could not answer"
        return json.dumps({"data": data, "error": error, "profile": None})


def _bound(name: str, function: Callable, args: list, options: dict) -> Callable[[], object]:
    """Return a function with the arguments of a call.

    Raises
    ------
    RequestError
        If they are not those of the function.
    """
    try:
        given = inspect.signature(function).bind(*args, **options)
    except TypeError as error:
        raise RequestError(f"{name} cannot be called so: {error}") from None
    id = given.arguments.get("id")
    if "id" in given.arguments and not isinstance(id, str):
        raise RequestError(f"the id of a job must be a string, as submit returns it, not {json.dumps(id)[:40]}")
    return functools.partial(function, *given.args, **given.kwargs)


class Handler(SimpleXMLRPCRequestHandler):
    """Refuses requests of web pages, and those that are too large."""

    rpc_paths = ("/", "/RPC2")

    def do_POST(self) -> None:  # noqa: N802
        """Answer a call."""
        host = self.headers.get("Host", "").rpartition(":")[0] or self.headers.get("Host", "")
        length = self.headers.get("Content-Length", "")
        if host not in LOOPBACK or self.headers.get("Origin") is not None:
            self.send_error(403)
        elif not length.isdecimal() or int(length) > Limits().body:
            self.send_error(413)
        else:
            super().do_POST()


class RPCServer(ThreadingMixIn, Server):
    """A server that answers while it solves."""

    daemon_threads = True

    def __init__(self, address: tuple[str, int]):
        Server.__init__(self, address, requestHandler=Handler, logRequests=False)


def start_service(port: int = PORT, workers: Optional[int] = None) -> None:
    """Serve on this machine until told to stop."""
    limits = Limits()
    # The address is taken first, so that a second service ends at once.
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
    """Run the service from a command line as Proxy makes it."""
    parser = argparse.ArgumentParser(prog="python -m compas_cgc.rpc.service", description="Serve compas.rpc on this machine.")
    parser.add_argument("--port", type=int, default=PORT, help=f"port (default {PORT})")
    parser.add_argument("--workers", type=int, help="solves at the same time")
    for name in ("--autoreload", "--no-autoreload"):
        parser.add_argument(name, action="store_true", help="taken because Proxy sends it; does nothing")
    arguments = parser.parse_args(argv)
    try:
        start_service(arguments.port, arguments.workers)
    except OSError as error:
        print(f"port {arguments.port} cannot be used ({error.strerror}); give another with --port", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
