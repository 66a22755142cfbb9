"""Worker: a process that runs one task after another and can be told to stop.

A task is any function. While it runs it may call :func:`report` to tell how far it is and
:func:`stop_wanted` to learn whether it should end early; outside of a worker both do nothing.
"""

from __future__ import annotations

import os
import signal
import threading
import traceback
from multiprocessing import connection
from multiprocessing import parent_process
from typing import Any
from typing import Callable
from typing import Optional

__all__ = ["report", "run_tasks", "stop_wanted"]

_line: Optional[connection.Connection] = None
_flag: Any = None


def report(progress: object) -> None:
    """Send something to whoever waits for the running task."""
    if _line is not None:
        _line.send(("progress", progress))


def stop_wanted() -> bool:
    """Tell whether the running task should end early."""
    return _flag is not None and bool(_flag.value)


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
    global _line, _flag
    # Ctrl-C in a terminal reaches all processes of it; the server decides what to do.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    if warm_up is not None:
        warm_up()
    _line, _flag = line, flag
    line.send(("ready", None))
    while True:
        try:
            function, args, kwargs = line.recv()
        except (EOFError, OSError):
            return
        try:
            message = ("result", function(*args, **kwargs))
        except Exception as error:
            message = ("error", (type(error).__name__, str(error), traceback.format_exc(), getattr(error, "status", None)))
        line.send(message)


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        connection.wait([parent.sentinel])
        os._exit(0)
