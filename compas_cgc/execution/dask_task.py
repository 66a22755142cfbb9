"""A task on a worker of Dask: it tells that it has begun and how far it is, and hears that it should end."""

from __future__ import annotations

import threading
from typing import Any
from typing import Callable

from .._version import __version__
from .worker import connected
from .worker import outcome

__all__ = ["about", "ask_to_stop", "run_task"]

LARGEST = 100_000  # bytes of a report's part that are sent by way of the scheduler; a live surface beyond is left out

_stops: dict[str, threading.Event] = {}


class _Events:
    """The channel of a task: reports are events of Dask, which go by way of the scheduler."""

    def __init__(self, worker: Any, topic: str, name: str, stop: threading.Event):
        self.worker, self.topic, self.name, self.stop = worker, topic, name, stop

    def tell(self, kind: str, content: object) -> None:
        self.worker.log_event(self.topic, {"task": self.name, "kind": kind, "content": content})

    def report(self, progress: object) -> None:
        if isinstance(progress, dict):
            progress = {key: value for key, value in progress.items() if not (isinstance(value, bytes) and len(value) > LARGEST)}
        self.tell("progress", progress)

    def stop_wanted(self) -> bool:
        return self.stop.is_set() or self._is_abandoned()

    def _is_abandoned(self) -> bool:
        """Check whether Dask has let go of the task, as it does when the process that waits for it is gone."""
        try:
            state = self.worker.state.tasks.get(self.name)
        except AttributeError:  # as Dask names it today
            return False
        return state is None or state.state in ("cancelled", "forgotten", "released")


def run_task(topic: str, name: str, function: Callable, args: tuple, kwargs: dict) -> tuple[str, Any]:
    """Run a call; return what :func:`~compas_cgc.execution.worker.outcome` does.

    Parameters
    ----------
    topic
        Of the events.
    name
        Of the task, Dask's key.
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
    """Ask a task that runs in this process to end; tell whether there is one that hears it."""
    stop = _stops.get(name)
    if stop is not None:
        stop.set()
    return stop is not None


def about() -> str:
    """Return the version of the package on a worker."""
    return __version__
