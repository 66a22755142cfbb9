"""Server start-up: find a running server, or start one that other programs can use too."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Callable
from typing import Optional
from typing import Union

from .client import Client
from .errors import ServerUnavailable

__all__ = ["ensure_server"]


def ensure_server(
    url: str = "http://127.0.0.1:7331",
    key: Optional[str] = None,
    python: Union[str, os.PathLike, None] = None,
    version: Optional[str] = None,
    log: Union[str, os.PathLike, None] = None,
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

    Raises
    ------
    ServerUnavailable
        If there is none and none can be started; it names the log.
    """
    client = Client(url, key, retries=0, timeout=5.0)
    found = _found(client)
    if found is None:
        host, _, port = url.split("//")[-1].rstrip("/").rpartition(":")
        if host not in ("127.0.0.1", "localhost") or not port.isdecimal():
            raise ServerUnavailable(
                f"no server answers at {url}, and only one on this machine can be started, such as http://127.0.0.1:7331"
            )
        log = Path(log) if log is not None else Path(tempfile.gettempdir()) / f"compas_cgc-{port}.log"
        say(f"starting a server of compas_cgc at {url}; its log is {log}")
        found = _start(client, _python(python), port, key, log, patience)
    if version is not None and found["version"] != version:
        raise ServerUnavailable(f"the server at {url} is compas_cgc {found['version']}, not {version}; stop it, or take another port")
    return Client(url, key)


def _found(client: Client) -> Optional[dict]:
    try:
        return client.version()
    except ServerUnavailable as error:
        if "no server answers" in str(error):
            return None
        raise


def _python(python: Union[str, os.PathLike, None]) -> str:
    if python is not None:
        return str(python)
    if not Path(sys.executable or "").name.lower().startswith("python"):
        raise ServerUnavailable("give the Python that has compas_cgc, as python=...; this program is not one that can run a server")
    return sys.executable


def _start(client: Client, python: str, port: str, key: Optional[str], log: Path, patience: float) -> dict:
    environment = {**os.environ, **({"COMPAS_CGC_KEY": key} if key else {})}
    # The server outlives this program and is not stopped with it.
    apart: dict = {"creationflags": 0x00000208} if sys.platform == "win32" else {"start_new_session": True}
    try:
        file = open(log, "ab")
    except OSError as error:
        raise ServerUnavailable(f"the log {log} cannot be written ({error.strerror}); give another as log=...") from None
    command = [python, "-m", "compas_cgc", "serve", "--port", port]
    try:
        with file:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=file, stderr=file, env=environment, **apart)
    except OSError as error:
        raise ServerUnavailable(f"{python} cannot be run ({error.strerror}); give the Python that has compas_cgc") from None
    end = time.monotonic() + patience
    while time.monotonic() < end:
        found = _found(client)
        if found is not None:
            return found
        if process.poll() is not None:
            last = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()[-1:]
            raise ServerUnavailable(f"the server ended at once: {''.join(last) or 'it said nothing'} (its log is {log})")
        time.sleep(0.1)
    process.terminate()
    raise ServerUnavailable(f"the server did not answer within {patience:g} seconds; its log is {log}")
