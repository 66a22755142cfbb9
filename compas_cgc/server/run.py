"""Run the server with waitress until it is interrupted."""

from __future__ import annotations

import json
import os
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
from .limits import Limits
from .memory import give_back
from .memory import set_loaded_aside
from .security import hostname
from .security import is_loopback
from .security import keys_of

if TYPE_CHECKING:
    from ..execution.protocol import TaskExecutor
    from .jobs.engine import Jobs

__all__ = ["HOST", "PORT", "default_store", "serve"]

HOST, PORT = "127.0.0.1", 7331
CONNECTIONS = 800  # at once; where there is no poll, no more than about a thousand files can be waited for


def default_store(port: int) -> Path:
    """Return where the jobs of a server are kept: one file per port in the user's folder for such things."""
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
    key: Union[str, Sequence[str], None] = None,
    workers: Optional[int] = None,
    store: Optional[str] = None,
    limits: Optional[Limits] = None,
    names: tuple[str, ...] = (),
    trusted_proxy: Optional[str] = None,
    executor: Optional[str] = None,
) -> None:
    """Serve until interrupted.

    Parameters
    ----------
    host
        Address to listen on; any but this machine's own needs a key.
    port
        0 for any free one.
    key
        What clients have to send: one key, or several, each of which has limits of its own.
    workers
        Number of worker processes.
    store
        File that keeps the jobs. Default: one of the user's, by the port.
    limits
        What is refused.
    names
        Host names under which clients reach the server.
    trusted_proxy
        Address of the proxy in front of the server: the last address of its X-Forwarded-For is the client's.
    executor
        Address of what runs the solves instead of worker processes, such as ``dask://scheduler:8786``.

    Raises
    ------
    CGCError
        If there is no key where one is needed, the port is taken, or there is no such kind of executor.

    Examples
    --------
    >>> serve(port=7331)  # doctest: +SKIP
    """
    keys = keys_of(key)
    if not is_loopback(host) and not keys:
        raise CGCError(
            f"listening on {host} needs a key, or anybody on the network could use this machine; set one with --key or COMPAS_CGC_KEY"
        )
    if any(len(own) < 8 or not own.isascii() or not own.isprintable() or " " in own for own in keys):
        raise CGCError("the key must be 8 or more plain letters, digits and signs")
    names = tuple(hostname(name.split("//")[-1]) for name in names)
    if not all(names):
        raise CGCError("a name must be that of a host, such as studio-pc; give it with --name")
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
    # Imported late: a refusal should not wait for it.
    from waitress.server import create_server

    from .app import create_app
    from .waitress_channel import channel_class
    from .waitress_threads import Threads

    own_names = () if host in ("0.0.0.0", "::") else (host.lower(),)
    app = create_app(store or default_store(port), keys, workers, limits, (*names, *own_names), remote)
    server: Any = create_server(
        app,
        _dispatcher=Threads(limits.threads),
        sockets=[listener],
        threads=limits.threads,
        connection_limit=CONNECTIONS,
        asyncore_use_poll=True,
        # A body too large is read on and dropped, so that the client hears why; beyond this the connection is broken.
        max_request_body_size=16 * limits.body,
        channel_request_lookahead=1,
        # By large pieces a large body keeps the thread that looks after all connections less busy.
        recv_bytes=2**16,
        # Who sends half a request keeps a connection for no longer.
        channel_timeout=30,
        ident=None,
        clear_untrusted_proxy_headers=True,
        **({"trusted_proxy": trusted_proxy, "trusted_proxy_headers": {"x-forwarded-for"}} if trusted_proxy else {}),
    )
    server.channel_class = channel_class(limits, trusted_proxy, keys)
    everywhere = host in ("0.0.0.0", "::")
    shown = "127.0.0.1" if everywhere else f"[{host}]" if ":" in host else host
    print(f"compas_cgc {__version__} is at http://{shown}:{port} ({'with' if keys else 'without'} a key); Ctrl-C ends it")
    print(f"Grasshopper: put a Hops component and set its path to http://{shown}:{port}/cgc/dome", flush=True)
    if everywhere:
        print(f"other machines reach it under {' or '.join(names) or 'no name yet: give those of this machine with --name'}", flush=True)
    jobs = app.extensions["jobs"]
    _end_on_signals(jobs)
    threading.Thread(target=_say_ready, args=(jobs.executor,), daemon=True).start()
    try:
        server.run()
    finally:
        server.close()
        jobs.close()
        print("stopped", flush=True)


def _say_ready(pool: TaskExecutor) -> None:
    from .api.warm_up import load_for_answers

    load_for_answers()
    set_loaded_aside()
    if pool.wait_until_ready(600):
        count = pool.health()["workers"]
        print(f"ready, {count} worker{'' if count == 1 else 's'}", flush=True)


def _end_on_signals(jobs: Jobs) -> None:
    def interrupt(number: int, frame: object) -> None:
        # waitress waits for its threads, and these wait for their solves.
        threading.Thread(target=jobs.close).start()
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, interrupt)
    signal.signal(signal.SIGTERM, interrupt)


def _listen(host: str, port: int) -> socket.socket:
    """Return a socket that listens, or say who does already."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listener = socket.socket(family, socket.SOCK_STREAM)
    if sys.platform != "win32":
        # On Windows this would let two servers share the port.
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
        return f": a server of {found['name']} {found['version']} runs there already"
    except (OSError, ValueError, KeyError, TypeError):
        return ""
