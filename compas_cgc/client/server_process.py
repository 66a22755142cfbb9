"""Server process: a compute server that is found at an address, or started there."""

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

POLL_INTERVAL = 0.1  # seconds between two looks at a new server
LOCAL = ("127.0.0.1", "localhost")


class ServerProcess(NamedTuple):
    """A server that was started."""

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
    """Return a client of the server at an address; if none answers there, start one that goes on running.

    Parameters
    ----------
    url
        Address on this machine.
    key
        Key of the server.
    python
        Python that has compas_cgc and shall run a new server. Inside of Rhino it must be
        given. Default: the one that runs this program.
    version
        Version that the server has to be of. Default: any of the same interface.
    log
        File for what a new server says. Default: one in the folder for temporary files.
    patience
        Seconds to wait for a new server.
    say
        Called with a sentence on what was done.

    Returns
    -------
    Client
        Of the server that answers at the address.

    Raises
    ------
    ServerUnavailable
        If there is none and none can be started; it names the log.

    Examples
    --------
    >>> client = ensure_server()  # doctest: +SKIP
    """
    client = Client(url, key, retries=0, timeout=5.0)
    found = find_server(client)
    if found is None:
        if python is None and own_python() is None:
            raise ServerUnavailable("give the Python that has compas_cgc, as python=...; this program is not one that can run a server")
        server = start_server(url, key, python, log)
        say(f"starting a server of compas_cgc at {url}; its log is {server.log}")
        found = wait_for_server(client, server, patience)
    if version is not None and found["version"] != version:
        raise ServerUnavailable(f"the server at {url} is compas_cgc {found['version']}, not {version}; stop it, or take another port")
    return Client(url, key)


def find_server(client: Client) -> Optional[dict]:
    """Return name and version of the server that answers, None where none does.

    Raises
    ------
    ServerUnavailable
        If what answers is no server of this interface.
    """
    try:
        return client.version()
    except ServerUnavailable as error:
        if "no server answers" in str(error):
            return None
        raise


def own_python() -> Optional[str]:
    """Return the Python that runs this program, None inside of Rhino and other programs that are none."""
    return sys.executable if Path(sys.executable or "").name.lower().startswith("python") else None


def start_server(
    url: str, key: Optional[str] = None, python: Optional[PathLike] = None, log: Optional[PathLike] = None, detached: bool = True
) -> ServerProcess:
    """Start a server, without waiting for it to answer.

    Parameters
    ----------
    url, key, python, log
        As for :func:`ensure_server`.
    detached
        Let it outlive this program.

    Raises
    ------
    ServerUnavailable
        If it cannot be started.
    """
    port = _local_port(url)
    path = Path(tempfile.gettempdir()) / f"compas_cgc-{port}.log" if log is None else Path(log)
    try:
        file = open(path, "ab")
    except OSError as error:
        raise ServerUnavailable(f"the log {path} cannot be written ({error.strerror}); give another as log=...") from None
    command = [str(python or own_python() or "python"), "-m", "compas_cgc", "serve", "--port", port]
    environment = {**os.environ, **({"COMPAS_CGC_KEY": key} if key else {})}
    try:
        with file:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=file, stderr=file, env=environment, **_creation(detached))
    except OSError as error:
        raise ServerUnavailable(f"{command[0]} cannot be run ({error.strerror}); give the path of a Python that has compas_cgc") from None
    return ServerProcess(process, path)


def wait_for_server(client: Client, server: ServerProcess, patience: float = 60.0, waiting: Callable[[], object] = lambda: False) -> dict:
    """Return name and version of a new server when it answers, or stop it.

    Parameters
    ----------
    client
        Of the server.
    server
        The server.
    patience
        Seconds to wait.
    waiting
        Called again and again; True gives up.

    Raises
    ------
    ServerUnavailable
        If it has ended, does not answer in time or was given up.
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
                raise ServerUnavailable(f"the server did not answer within {patience:g} seconds; its log is {server.log}")
            time.sleep(POLL_INTERVAL)
        raise ServerUnavailable("stopped")
    except BaseException:
        stop_server(server.process)
        raise


def stop_server(process: Optional[subprocess.Popen]) -> None:
    """Stop a server that runs."""
    if process is not None and process.poll() is None:
        process.terminate()


def _local_port(url: str) -> str:
    host, _, port = url.split("//")[-1].rstrip("/").rpartition(":")
    if host not in LOCAL or not port.isdecimal():
        raise ServerUnavailable(f"no server answers at {url}, and only one on this machine can be started, such as http://127.0.0.1:7331")
    return port


def _creation(detached: bool) -> dict:
    """Return what keeps a process off the screen, and alive after this program where it is detached."""
    if sys.platform == "win32":
        return {"creationflags": 0x00000208 if detached else 0x08000000}
    return {"start_new_session": True} if detached else {}


def _last_line(log: Path) -> str:
    lines = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
    return lines[-1] if lines else "it said nothing"
