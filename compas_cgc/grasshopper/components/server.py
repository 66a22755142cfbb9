"""Server: the compute server that Solve and Hops use."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any
from typing import NamedTuple
from typing import Optional

from ...client.server_process import stop_server
from ..runtime.address import Address
from ..runtime.background import BackgroundTask
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import run_again
from ..runtime.component_feedback import set_message
from ..runtime.memories import Memories
from ..runtime.server_process import RunningServer
from ..runtime.server_process import find_or_start

__all__ = ["ServerOutputs", "server"]

URL = "http://127.0.0.1:7331"
POLL_INTERVAL = 300  # [ms]


class ServerOutputs(NamedTuple):
    """Outputs of the component."""

    server: Optional[Address] = None
    url: Optional[str] = None
    status: Optional[str] = None


@dataclass
class Memory:
    """State of a component between two runs."""

    inputs: tuple
    task: BackgroundTask[RunningServer]

    def end(self) -> None:
        """Stop the server or its start, unless the server was running before."""
        self.task.cancel()
        if self.task.result is not None:
            stop_server(self.task.result.process)


_MEMORIES: Memories[Memory] = Memories(Memory.end)


@reports_errors(ServerOutputs)
def server(component: Any, run: Optional[bool], url: Optional[str], key: Optional[str], python: Optional[str]) -> ServerOutputs:
    """Find a server, or start one that stops with the toggle, the component or Rhino."""
    address = Address.from_text(url if url and url.strip() else URL, key)
    memory = _MEMORIES.of(component)

    def forget() -> None:
        _MEMORIES.drop_all(component)

    if memory is not None and (not run or memory.inputs != (address, python)):
        forget()
        memory = None
    if not run:
        set_message(component, "set run to true")
        return ServerOutputs(status="not running")
    if memory is None:
        memory = _MEMORIES.keep(component, Memory((address, python), BackgroundTask(find_or_start(address, python))))
    return _state(component, address, memory.task, forget)


def _state(component: Any, address: Address, task: BackgroundTask[RunningServer], forget: Callable[[], None]) -> ServerOutputs:
    if task.running:
        set_message(component, "starting")
        run_again(component, POLL_INTERVAL, forget)
        return ServerOutputs(status=task.progress.note or "starting")
    found = task.result
    if found is None:
        set_message(component, "not running")
        raise task.error or RuntimeError("the task ended without a result")
    if found.process is not None and found.process.poll() is not None:
        forget()
        run_again(component, POLL_INTERVAL, forget)
        return ServerOutputs(status="the server stopped; restarting it")
    set_message(component, "running")
    origin = "already running" if found.process is None else "started here"
    return ServerOutputs(address, address.url, f"compas_cgc {found.version} at {address.url}, {origin}")
