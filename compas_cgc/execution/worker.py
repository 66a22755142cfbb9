"""Worker: a process that runs one task after another and handles stop requests.

A task is any function. It may call :func:`report` to report progress and :func:`stop_wanted` to check for a stop request; outside
a worker, both have no effect. They use a channel: a pipe of the pool, or the channel of another executor.
"""

from __future__ import annotations

import os
import signal
import threading
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import connection
from multiprocessing import parent_process
from typing import Any
from typing import Callable
from typing import NamedTuple
from typing import Optional
from typing import Protocol

from ..errors import sentence_of

__all__ = ["Channel", "connected", "outcome", "report", "run_tasks", "stop_wanted"]


class Channel(Protocol):
    """Connection between a running task and its client."""

    def report(self, progress: object) -> None:
        """Send a progress report to the client."""

    def stop_wanted(self) -> bool:
        """Check whether the task should end early."""
        ...


class _Own(threading.local):
    """Channel of the task of a thread."""

    channel: Optional[Channel] = None


_own = _Own()


@contextmanager
def connected(channel: Channel) -> Iterator[None]:
    """Connect the task of this thread to a channel within a block."""
    _own.channel = channel
    try:
        yield
    finally:
        _own.channel = None


def report(progress: object) -> None:
    """Send a progress report of the running task to its client."""
    if _own.channel is not None:
        _own.channel.report(progress)


def stop_wanted() -> bool:
    """Check whether the running task should end early."""
    return _own.channel is not None and _own.channel.stop_wanted()


def outcome(function: Callable, args: tuple, kwargs: dict) -> tuple[str, Any]:
    """Return ``("result", x)`` of a call, or ``("error", (class name, message, traceback, HTTP status or None))``."""
    try:
        return "result", function(*args, **kwargs)
    except Exception as error:
        return "error", (type(error).__name__, sentence_of(error), traceback.format_exc(), getattr(error, "status", None))


class _Pipe(NamedTuple):
    """Channel of a process of the pool."""

    line: connection.Connection
    flag: Any
    seen: list[bool]  # whether the task saw that it should end

    def report(self, progress: object) -> None:
        self.line.send(("progress", progress))

    def stop_wanted(self) -> bool:
        if not self.flag.value:
            return False
        self.seen.append(True)
        return True


def run_tasks(line: connection.Connection, flag: object, warm_up: Optional[Callable[[], object]], niceness: int = 0) -> None:
    """Run the tasks received from a pipe until it is closed; main function of a worker process.

    Parameters
    ----------
    line
        Pipe that delivers ``(function, args, kwargs)`` and accepts ``("ready", None)``, ``("progress", x)``,
        ``("result", x)`` and ``("error", (class name, message, traceback, HTTP status or None))``.
    flag
        Shared byte that is nonzero when the running task should stop.
    warm_up
        Called before the first task.
    niceness
        By how much the system prefers other processes, see :func:`os.nice`.
    """
    # Before the libraries start their threads, which inherit it.
    if niceness and hasattr(os, "nice"):
        os.nice(niceness)
    # Ctrl-C in a terminal reaches all its processes; only the server handles it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    if warm_up is not None:
        warm_up()
    line.send(("ready", None))
    while True:
        try:
            function, args, kwargs = line.recv()
        except (EOFError, OSError):
            return
        channel = _Pipe(line, flag, [])
        with connected(channel):
            message = outcome(function, args, kwargs)
        line.send(("stopped", message) if channel.seen else message)


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        connection.wait([parent.sentinel])
        os._exit(0)
