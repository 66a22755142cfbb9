"""A task on a Dask worker, with progress reports and stop requests."""

from __future__ import annotations

import threading
from typing import Any
from typing import Callable

from .._version import __version__
from .worker import connected
from .worker import outcome

__all__ = ["about", "ask_to_stop", "run_task"]

MAX_REPORT = 100_000  # size above which an item of a report is omitted, as reports go through the scheduler [bytes]

_stops: dict[str, threading.Event] = {}


class _Events:
    """Channel of a task: reports are Dask events, which are sent through the scheduler."""

    def __init__(self, worker: Any, topic: str, name: str, stop: threading.Event):
        self.worker, self.topic, self.name, self.stop = worker, topic, name, stop

    def tell(self, kind: str, content: object) -> None:
        self.worker.log_event(self.topic, {"task": self.name, "kind": kind, "content": content})

    def report(self, progress: object) -> None:
        if isinstance(progress, dict):
            progress = {key: value for key, value in progress.items() if not (isinstance(value, bytes) and len(value) > MAX_REPORT)}
        self.tell("progress", progress)

    def stop_wanted(self) -> bool:
        return self.stop.is_set() or self._is_abandoned()

    def _is_abandoned(self) -> bool:
        """Check whether Dask has released the task, for example because the waiting process ended."""
        try:
            state = self.worker.state.tasks.get(self.name)
        except AttributeError:  # private attribute of Dask
            return False
        return state is None or state.state in ("cancelled", "forgotten", "released")


def run_task(topic: str, name: str, function: Callable, args: tuple, kwargs: dict) -> tuple[str, Any]:
    """Run a call; return what :func:`~compas_cgc.execution.worker.outcome` does.

    Parameters
    ----------
    topic
        Dask topic of the events.
    name
        Dask key of the task.
    function, args, kwargs
        The call.
    """
    from distributed import get_worker

    worker = get_worker()
    stop = _stops[name] = threading.Event()
    channel = _Events(worker, topic, name, stop)
    channel.tell("started", worker.address)
    try:
        with connected(channel):
            return outcome(function, args, kwargs)
    finally:
        _stops.pop(name, None)


def ask_to_stop(name: str) -> bool:
    """Request that a task in this process stop; return whether the task exists."""
    stop = _stops.get(name)
    if stop is not None:
        stop.set()
    return stop is not None


def about() -> str:
    """Return the version of the package on a worker."""
    return __version__
