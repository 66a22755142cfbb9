"""Server: the compute server that Solve and Hops use."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any
from typing import NamedTuple
from typing import Optional

from ..runtime.address import Address
from ..runtime.background import Work
from ..runtime.component_feedback import reporting
from ..runtime.component_feedback import run_again
from ..runtime.component_feedback import say
from ..runtime.server_process import Found
from ..runtime.server_process import find_or_start
from ..runtime.server_process import stop

__all__ = ["ServerOutputs", "server"]

URL = "http://127.0.0.1:7331"
POLL = 300  # [ms]


class ServerOutputs(NamedTuple):
    """Outputs of the component."""

    server: Optional[Address] = None
    url: Optional[str] = None
    status: Optional[str] = None


@dataclass
class Memory:
    """What a component on the canvas remembers from one run to the next."""

    asked: tuple
    work: Work[Found]

    def end(self) -> None:
        """Stop the server, or the attempt to start it; one that ran before is left alone."""
        self.work.cancel()
        if self.work.outcome is not None:
            stop(self.work.outcome.process)


_MEMORIES: dict[str, Memory] = {}


@reporting(ServerOutputs)
def server(component: Any, run: Optional[bool], url: Optional[str], key: Optional[str], python: Optional[str]) -> ServerOutputs:
    """Find a server, or start one that ends with the toggle, the component or Rhino."""
    name = str(component.InstanceGuid)
    address = Address(url.strip() if url else URL, key.strip() if key else None)
    asked = (address, python)
    memory = _MEMORIES.get(name)

    def forget() -> None:
        known = _MEMORIES.pop(name, None)
        if known is not None:
            known.end()

    if memory is not None and (not run or memory.asked != asked):
        forget()
    if not run:
        say(component, "set run to true")
        return ServerOutputs(status="not running")
    memory = _MEMORIES.get(name)
    if memory is None:
        memory = _MEMORIES[name] = Memory(asked, Work(find_or_start(address, python)))
    if memory.work.running:
        say(component, "starting")
        run_again(component, POLL, forget)
        return ServerOutputs(status=memory.work.progress.note or "starting")
    if memory.work.refusal is not None:
        say(component, "not running")
        raise memory.work.refusal
    return _found(component, address, memory.work.outcome, forget)


def _found(component: Any, address: Address, found: Found, forget: Any) -> ServerOutputs:
    if found.process is not None and found.process.poll() is not None:
        forget()
        run_again(component, POLL, forget)
        return ServerOutputs(status="the server has ended; starting it again")
    say(component, "running")
    origin = "it ran before" if found.process is None else "started here"
    return ServerOutputs(address, address.url, f"compas_cgc {found.version} at {address.url}, {origin}")
