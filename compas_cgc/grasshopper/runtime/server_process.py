"""Server process of the canvas: finds a running server, or starts and stops one."""

from __future__ import annotations

import atexit
import subprocess
from collections.abc import Callable
from typing import NamedTuple
from typing import Optional

from ...client import Client
from ...client import ServerUnavailable
from ...client.server_process import find_server
from ...client.server_process import own_python
from ...client.server_process import start_server
from ...client.server_process import stop_server
from ...client.server_process import wait_for_server
from ...errors import CGCError
from .address import Address
from .progress import Progress
from .progress import Report

__all__ = ["RunningServer", "find_or_start"]


class RunningServer(NamedTuple):
    """A responding server."""

    version: str
    process: Optional[subprocess.Popen]  # None if the server was already running


def find_or_start(address: Address, python: Optional[str]) -> Callable[[Report], RunningServer]:
    """Return a function that finds a server at an address or starts one there, for a background task.

    Parameters
    ----------
    address
        Address of the server; a server can only be started on this machine.
    python
        Path of a Python with compas_cgc. Default: the running Python, which is not available inside Rhino.
    """

    def run(report: Report) -> RunningServer:
        try:
            return _found_or_started(address, python, report)
        except ServerUnavailable as error:
            raise CGCError(str(error)) from None

    return run


def _found_or_started(address: Address, python: Optional[str], report: Report) -> RunningServer:
    client = Client(address.url, address.key, retries=0, timeout=5.0)
    found = find_server(client)
    if found is not None:
        return RunningServer(found["version"], None)
    if not python and own_python() is None:
        raise CGCError("no server is running, and Rhino cannot start one; connect the path of a Python with compas_cgc")
    server = start_server(address.url, address.key, python.strip() if python else None, detached=False)
    atexit.register(stop_server, server.process)
    starting = Progress(note=f"starting; the log is {server.log}")
    found = wait_for_server(client, server, waiting=lambda: report(starting))
    return RunningServer(found["version"], server.process)
