"""A server for the canvas: found, or started and stopped with it."""

from __future__ import annotations

import atexit
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple
from typing import Optional

from ...client import Client
from ...client import ServerUnavailable
from ...errors import CGCError
from .address import Address
from .background import Progress

__all__ = ["Found", "find_or_start", "stop"]

PATIENCE = 60.0  # seconds until a new server has to answer


class Found(NamedTuple):
    """A server that answers."""

    version: str
    process: Optional[subprocess.Popen]  # None where it ran before


def find_or_start(address: Address, python: Optional[str]) -> Callable[[Callable[[Progress], bool]], Found]:
    """Return the work of finding a server at an address or starting one there.

    Parameters
    ----------
    address
        On this machine, if it has to be started.
    python
        Python that has compas_cgc. Default: the one that runs this, which is none inside of Rhino.
    """

    def work(tell: Callable[[Progress], bool]) -> Found:
        client = Client(address.url, address.key, retries=0, timeout=5.0)
        try:
            return Found(client.version()["version"], None)
        except ServerUnavailable as error:
            if "no server answers" not in str(error):
                raise CGCError(str(error)) from None
        log = Path(tempfile.gettempdir()) / f"compas_cgc-{_port(address)}.log"
        process = _start(address, _python(python), log)
        end = time.monotonic() + PATIENCE
        try:
            while not tell(Progress(note=f"starting; the log is {log}")):
                if process.poll() is not None or time.monotonic() > end:
                    last = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()[-1:]
                    raise CGCError(f"the server did not start: {''.join(last) or 'it said nothing'} (its log is {log})")
                try:
                    return Found(client.version()["version"], process)
                except ServerUnavailable:
                    time.sleep(0.1)
        except BaseException:
            stop(process)
            raise
        stop(process)
        raise CGCError("stopped")

    return work


def stop(process: Optional[subprocess.Popen]) -> None:
    """Stop a server that was started here."""
    if process is not None and process.poll() is None:
        process.terminate()


def _port(address: Address) -> str:
    host, _, port = address.url.split("//")[-1].rstrip("/").rpartition(":")
    if host not in ("127.0.0.1", "localhost") or not port.isdecimal():
        raise CGCError(f"no server answers at {address.url}, and only one on this machine can be started, such as http://127.0.0.1:7331")
    return port


def _python(python: Optional[str]) -> str:
    if python:
        return python.strip()
    if not Path(sys.executable or "").name.lower().startswith("python"):
        raise CGCError("no server answers, and Rhino itself cannot run one; connect the path of a Python that has compas_cgc")
    return sys.executable


def _start(address: Address, python: str, log: Path) -> subprocess.Popen:
    environment = {**os.environ, **({"COMPAS_CGC_KEY": address.key} if address.key else {})}
    hidden: dict = {"creationflags": 0x08000000} if sys.platform == "win32" else {}
    command = [python, "-m", "compas_cgc", "serve", "--port", _port(address)]
    try:
        with open(log, "wb") as file:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=file, stderr=file, env=environment, **hidden)
    except OSError as error:
        raise CGCError(f"{python} cannot be run ({error.strerror}); connect the path of a Python that has compas_cgc") from None
    atexit.register(stop, process)
    return process
