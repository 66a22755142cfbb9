"""Run the server with waitress until it is interrupted."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import sys
import threading
import urllib.request
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Any
from typing import Optional
from typing import Union

from .._version import __version__
from ..errors import CGCError
from ..execution.remote import executor_at
from .keys import Keys
from .limits import Limits
from .memory import give_back
from .memory import set_loaded_aside
from .security import hostname
from .security import is_loopback

if TYPE_CHECKING:
    from ..execution.protocol import TaskExecutor
    from .jobs.engine import Jobs

__all__ = ["HOST", "PORT", "default_store", "serve"]

HOST, PORT = "127.0.0.1", 7331
CONNECTIONS = 800  # simultaneous connections; without poll, select is limited to about 1000 files


def default_store(port: int) -> Path:
    """Return the default path of the job store: one file per port in the user's data folder."""
    if sys.platform == "win32":
        base = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Application Support"
    else:
        base = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state")
    return base / "compas_cgc" / f"jobs-{port}.sqlite"


def serve(
    host: str = HOST,
    port: int = PORT,
    key: Union[str, Sequence[str], Keys, None] = None,
    workers: Optional[int] = None,
    store: Optional[str] = None,
    limits: Optional[Limits] = None,
    names: tuple[str, ...] = (),
    trusted_proxy: Optional[str] = None,
    executor: Optional[str] = None,
    prefix: str = "",
    log: Optional[str] = None,
) -> None:
    """Run the server until it is interrupted.

    Parameters
    ----------
    host
        Address to listen on. Any address other than the local machine requires a key.
    port
        Port to listen on, 0 for any free port.
    key
        Key that clients must send, or several keys, each with its own limits.
    workers
        Number of worker processes.
    store
        File that stores the jobs. Default: :func:`default_store` of the port.
    limits
        Limits on the size and number of requests.
    names
        Host names under which clients reach the server.
    trusted_proxy
        Address of the proxy in front of the server; the last address in its X-Forwarded-For header is the client's.
    executor
        Address of the executor of the solves instead of worker processes, such as ``dask://scheduler:8786``.
    prefix
        Path under which the proxy publishes the server, such as ``/cgc``. Requests are answered with and without it.
    log
        ``"text"`` or ``"json"`` to log requests and jobs to standard error. Default: warnings only.

    Raises
    ------
    CGCError
        If a required key is missing, the port is in use, or the prefix or kind of executor is invalid.

    Examples
    --------
    >>> serve(port=7331)  # doctest: +SKIP
    """
    keys = key if isinstance(key, Keys) else Keys(key)
    if not is_loopback(host) and not keys:
        raise CGCError(f"listening on {host} requires a key, or anyone on the network could use this machine; set --key or COMPAS_CGC_KEY")
    names = tuple(hostname(name.split("//")[-1]) for name in names)
    if not all(names):
        raise CGCError("--name must be a host name, such as studio-pc")
    if not re.fullmatch(r"(/[A-Za-z0-9._~-]+)*", prefix):
        raise CGCError(f"the prefix must be a path such as /cgc, not {prefix!r:.60}")
    limits = limits or Limits()
    remote = None if executor is None else executor_at(executor, limits.reserved)
    give_back()
    try:
        listener = _listen(host, port)
    except CGCError:
        if remote is not None:
            remote.shutdown(cancel_futures=True)
        raise
    port = listener.getsockname()[1]
    # Imported late, so that errors in the arguments are reported at once.
    from waitress.server import create_server

    from .app import create_app
    from .operation.logs import log_to_stderr
    from .waitress_channel import channel_class
    from .waitress_threads import Threads

    log_to_stderr(log)
    own_names = () if host in ("0.0.0.0", "::") else (host.lower(),)
    app = create_app(store or default_store(port), keys, workers, limits, (*names, *own_names), remote)
    server: Any = create_server(
        app,
        _dispatcher=Threads(limits.threads),
        sockets=[listener],
        threads=limits.threads,
        connection_limit=CONNECTIONS,
        asyncore_use_poll=True,
        # The rest of a too large body is read and dropped up to this size, so that the client receives the error.
        max_request_body_size=16 * limits.body,
        channel_request_lookahead=1,
        # Large pieces of a body reduce the load of the thread that serves all connections.
        recv_bytes=2**16,
        # Closes connections with incomplete requests.
        channel_timeout=30,
        ident=None,
        url_prefix=prefix,
        clear_untrusted_proxy_headers=True,
        **({"trusted_proxy": trusted_proxy, "trusted_proxy_headers": {"x-forwarded-for"}} if trusted_proxy else {}),
    )
    server.adj.socket_options = _drop_vanished(limits.stall)
    server.channel_class = channel_class(limits, trusted_proxy, keys)
    everywhere = host in ("0.0.0.0", "::")
    shown = "127.0.0.1" if everywhere else f"[{host}]" if ":" in host else host
    print(f"compas_cgc {__version__} is at http://{shown}:{port} ({'with' if keys else 'without'} a key); Ctrl-C ends it")
    print(f"Grasshopper: put a Hops component and set its path to http://{shown}:{port}/cgc/dome", flush=True)
    if everywhere:
        print(f"other machines can reach it under {' or '.join(names) or 'no name yet: set its names with --name'}", flush=True)
    jobs = app.extensions["jobs"]
    _end_on_signals(jobs)
    threading.Thread(target=_say_ready, args=(jobs.executor,), daemon=True).start()
    try:
        server.run()
    finally:
        server.close()
        jobs.close()
        print("stopped", flush=True)


def _drop_vanished(seconds: float) -> list[tuple[int, int, int]]:
    """Return the options of sockets that end connections to machines that no longer respond, where the system has them."""
    options = [(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1), (socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)]
    for name, value in (("TCP_KEEPIDLE", seconds), ("TCP_KEEPINTVL", seconds / 3), ("TCP_USER_TIMEOUT", 1000 * seconds)):
        if hasattr(socket, name):
            options.append((socket.IPPROTO_TCP, getattr(socket, name), max(1, round(value))))
    return options


def _say_ready(pool: TaskExecutor) -> None:
    from .api.warm_up import load_for_answers

    load_for_answers()
    set_loaded_aside()
    if pool.wait_until_ready(600):
        count = pool.health()["workers"]
        print(f"ready, {count} worker{'' if count == 1 else 's'}", flush=True)


def _end_on_signals(jobs: Jobs) -> None:
    def interrupt(number: int, frame: object) -> None:
        # End the solves first: waitress waits for its threads, and these wait for their solves.
        threading.Thread(target=jobs.close).start()
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, interrupt)
    signal.signal(signal.SIGTERM, interrupt)


def _listen(host: str, port: int) -> socket.socket:
    """Return a listening socket; raise an error that names the process using the port."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listener = socket.socket(family, socket.SOCK_STREAM)
    if sys.platform != "win32":
        # On Windows, this option would let two servers share the port.
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind((host, port))
    except OSError as error:
        listener.close()
        raise CGCError(
            f"the address {host}:{port} cannot be used ({error.strerror}){_who(host, port)}; choose another with --port"
        ) from None
    return listener


def _who(host: str, port: int) -> str:
    shown = f"[{host}]" if ":" in host else host
    try:
        with urllib.request.urlopen(f"http://{shown}:{port}/version", timeout=2.0) as answer:
            found = json.loads(answer.read(10_000))
        return f": a server of {found['name']} {found['version']} is already running there"
    except (OSError, ValueError, KeyError, TypeError):
        return ""
