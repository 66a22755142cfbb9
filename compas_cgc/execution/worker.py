"""Worker: a process that runs one task after another and can be told to stop.

A task is any function. While it runs it may call :func:`report` to tell how far it is and
:func:`stop_wanted` to learn whether it should end early; outside of a worker both do nothing. What carries them is a channel:
a pipe of the pool, or what another executor connects.
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

__all__ = ["Channel", "connected", "outcome", "report", "run_tasks", "stop_wanted"]


class Channel(Protocol):
    """What connects a running task with whoever waits for it."""

    def report(self, progress: object) -> None:
        """Send something to whoever waits."""

    def stop_wanted(self) -> bool:
        """Check whether the task should end early."""
        ...


class _Own(threading.local):
    """The channel of the task that a thread runs."""

    channel: Optional[Channel] = None


_own = _Own()


@contextmanager
def connected(channel: Channel) -> Iterator[None]:
    """Connect the task that this thread runs within a block."""
    _own.channel = channel
    try:
        yield
    finally:
        _own.channel = None


def report(progress: object) -> None:
    """Send something to whoever waits for the running task."""
    if _own.channel is not None:
        _own.channel.report(progress)


def stop_wanted() -> bool:
    """Check whether the running task should end early."""
    return _own.channel is not None and _own.channel.stop_wanted()


def outcome(function: Callable, args: tuple, kwargs: dict) -> tuple[str, Any]:
    """Return ``("result", x)`` of a call, or ``("error", (class name, sentence, traceback, HTTP status or None))``."""
    try:
        return "result", function(*args, **kwargs)
    except Exception as error:
        return "error", (type(error).__name__, str(error), traceback.format_exc(), getattr(error, "status", None))


class _Pipe(NamedTuple):
    """The channel of a process of the pool."""

    line: connection.Connection
    flag: Any

    def report(self, progress: object) -> None:
        self.line.send(("progress", progress))

    def stop_wanted(self) -> bool:
        return bool(self.flag.value)


def run_tasks(line: connection.Connection, flag: object, warm_up: Optional[Callable[[], object]]) -> None:
    """Run the tasks that come down a line until it is closed; the body of a worker process.

    Parameters
    ----------
    line
        Brings ``(function, args, kwargs)``; takes ``("ready", None)``, ``("progress", x)``,
        ``("result", x)`` and ``("error", (class name, sentence, traceback, HTTP status or None))``.
    flag
        Shared byte that is not zero when the running task should end.
    warm_up
        Called before the first task.
    """
    # Ctrl-C in a terminal reaches all processes of it; the server decides what to do.
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
        with connected(_Pipe(line, flag)):
            message = outcome(function, args, kwargs)
        line.send(message)


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        connection.wait([parent.sentinel])
        os._exit(0)
