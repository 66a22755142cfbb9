"""Server process: finds a compute server at an address, or starts one."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Callable
from typing import NamedTuple
from typing import Optional
from typing import Union

from .client import Client
from .errors import ServerUnavailable

__all__ = ["ServerProcess", "ensure_server", "find_server", "own_python", "start_server", "stop_server", "wait_for_server"]

PathLike = Union[str, os.PathLike]

POLL_INTERVAL = 0.1  # time between two checks of a new server [s]
LOCAL = ("127.0.0.1", "localhost")


class ServerProcess(NamedTuple):
    """A started server."""

    process: subprocess.Popen
    log: Path


def ensure_server(
    url: str = "http://127.0.0.1:7331",
    key: Optional[str] = None,
    python: Optional[PathLike] = None,
    version: Optional[str] = None,
    log: Optional[PathLike] = None,
    patience: float = 60.0,
    say: Callable[[str], object] = print,
) -> Client:
    """Return a client of the server at an address; if none responds, start one that outlives this program.

    Parameters
    ----------
    url
        Address on this machine.
    key
        Key of the server.
    python
        Path of a Python with compas_cgc that runs a new server; required inside Rhino.
        Default: the running Python.
    version
        Required version of the server. Default: any version with the same interface.
    log
        Log file of a new server. Default: a new file in the folder for temporary files.
    patience
        Longest time to wait for a new server [s].
    say
        Called with status messages.

    Returns
    -------
    Client
        Client of the server at the address.

    Raises
    ------
    ServerUnavailable
        If no server responds and none can be started; the message contains the path of the log.

    Examples
    --------
    >>> client = ensure_server()  # doctest: +SKIP
    """
    client = Client(url, key, retries=0, timeout=5.0)
    found = find_server(client)
    if found is None:
        if python is None and own_python() is None:
            raise ServerUnavailable("this program cannot run a server; give the path of a Python with compas_cgc as python=...")
        server = start_server(url, key, python, log)
        say(f"starting a server of compas_cgc at {url}; its log is {server.log}")
        found = wait_for_server(client, server, patience)
    if version is not None and found["version"] != version:
        raise ServerUnavailable(f"the server at {url} has version {found['version']}, not {version}; stop it, or use another port")
    return Client(url, key)


def find_server(client: Client) -> Optional[dict]:
    """Return name and version of the running server, None if no server responds.

    Raises
    ------
    ServerUnavailable
        If the address belongs to another program or an incompatible server.
    """
    try:
        return client.version()
    except ServerUnavailable as error:
        if "no server responds" in str(error):
            return None
        raise


def own_python() -> Optional[str]:
    """Return the path of the running Python, None inside Rhino and other host programs."""
    return sys.executable if Path(sys.executable or "").name.lower().startswith("python") else None


def start_server(
    url: str, key: Optional[str] = None, python: Optional[PathLike] = None, log: Optional[PathLike] = None, detached: bool = True
) -> ServerProcess:
    """Start a server without waiting for its response.

    Parameters
    ----------
    url, key, python, log
        As for :func:`ensure_server`.
    detached
        Whether the server outlives this program.

    Raises
    ------
    ServerUnavailable
        If the server cannot be started.
    """
    port = _local_port(url)
    path = None if log is None else Path(log)
    try:
        if path is None:
            # A predictable name could be a link that another user of the machine has put there.
            descriptor, name = tempfile.mkstemp(prefix=f"compas_cgc-{port}-", suffix=".log")
            file, path = open(descriptor, "ab"), Path(name)
        else:
            file = open(path, "ab")
    except OSError as error:
        path = path or Path(tempfile.gettempdir())
        raise ServerUnavailable(f"the log {path} cannot be written ({error.strerror}); choose another as log=...") from None
    command = [str(python or own_python() or "python"), "-m", "compas_cgc", "serve", "--port", port]
    environment = {**os.environ, **({"COMPAS_CGC_KEY": key} if key else {})}
    try:
        with file:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=file, stderr=file, env=environment, **_creation(detached))
    except OSError as error:
        raise ServerUnavailable(f"{command[0]} cannot be run ({error.strerror}); give the path of a Python with compas_cgc") from None
    return ServerProcess(process, path)


def wait_for_server(client: Client, server: ServerProcess, patience: float = 60.0, waiting: Callable[[], object] = lambda: False) -> dict:
    """Return name and version of a new server when it responds; stop it if it does not.

    Parameters
    ----------
    client
        Client of the server.
    server
        The server.
    patience
        Longest time to wait [s].
    waiting
        Called periodically; True cancels the start.

    Raises
    ------
    ServerUnavailable
        If the server ended, did not respond in time or was cancelled.
    """
    end = time.monotonic() + patience
    try:
        while not waiting():
            found = find_server(client)
            if found is not None:
                return found
            if server.process.poll() is not None:
                raise ServerUnavailable(f"the server did not start: {_last_line(server.log)} (its log is {server.log})")
            if time.monotonic() > end:
                raise ServerUnavailable(f"the server did not respond within {patience:g} s; its log is {server.log}")
            time.sleep(POLL_INTERVAL)
        raise ServerUnavailable("stopped")
    except BaseException:
        stop_server(server.process)
        raise


def stop_server(process: Optional[subprocess.Popen]) -> None:
    """Stop a running server."""
    if process is not None and process.poll() is None:
        process.terminate()


def _local_port(url: str) -> str:
    host, _, port = url.split("//")[-1].rstrip("/").rpartition(":")
    if host not in LOCAL or not port.isdecimal():
        raise ServerUnavailable(
            f"no server responds at {url}; a server can only be started on this machine, such as at http://127.0.0.1:7331"
        )
    return port


def _creation(detached: bool) -> dict:
    """Return process options that hide the window and, if detached, let the process outlive this program."""
    if sys.platform == "win32":
        return {"creationflags": 0x00000208 if detached else 0x08000000}
    return {"start_new_session": True} if detached else {}


def _last_line(log: Path) -> str:
    lines = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
    return lines[-1] if lines else "its log is empty"
