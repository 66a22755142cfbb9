"""Futures of calls that run in worker processes."""

from __future__ import annotations

import time
from collections.abc import Sequence
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeout
from typing import Any
from typing import Callable
from typing import Optional

__all__ = ["Task", "TaskError", "TaskStopped", "WorkerDied", "place", "start", "stop", "wait_for"]

POLL_INTERVAL = 0.1  # seconds between two checks whether somebody still waits
FAIR = 5.0  # seconds after which a task is no longer overtaken
GRACE = 0.15  # seconds that somebody waits for a task that was asked to stop


class WorkerDied(RuntimeError):
    """The process of a task ended before the task did."""


class TaskStopped(RuntimeError):
    """A task was ended by force: it did not stop within the grace period."""


class TaskError(RuntimeError):
    """A task raised an exception.

    Attributes
    ----------
    kind
        Name of its class.
    trace
        The worker's traceback.
    status
        HTTP status that tells of it, None where it is a fault of the program.
    """

    def __init__(self, kind: str, text: str, trace: str, status: Optional[int] = None):
        super().__init__(text)
        self.kind = kind
        self.trace = trace
        self.status = status


class Task(Future):
    """A future that can be stopped while it runs and tells how far it is.

    Attributes
    ----------
    on_progress
        Called with everything that the task reports.
    stop_reason
        Why it was asked to stop, None if it was not.
    urgent
        Goes before those that nobody waits for.
    since
        When it was handed in.
    on_late
        Called with the result where it comes after whoever waits was told that the task was stopped.
    grace
        Seconds after that in which it may still end by itself; then its worker ends it alone.
    """

    def __init__(self, call: tuple, on_progress: Optional[Callable[[object], object]], time_limit: Optional[float], urgent: bool = False):
        super().__init__()
        self.call: Optional[tuple] = call  # dropped once it is sent
        self.on_progress = on_progress
        self.time_limit = time_limit
        self.on_late: Optional[Callable[[Any], object]] = None
        self.stop_reason: Optional[str] = None
        self.stop_time = 0.0
        self.grace = GRACE
        self.urgent = urgent
        self.since = time.monotonic()

    def stop(self, reason: str = "cancelled", grace: float = GRACE) -> None:
        """Cancel the task if it waits, ask it to end if it runs."""
        if not self.cancel() and self.stop_reason is None:
            self.stop_time = time.monotonic()
            self.grace = grace
            self.stop_reason = reason


def place(task: Task, waiting: Sequence[Task]) -> int:
    """Return the place of a task in a queue: an urgent one goes before those that have not waited long."""
    if not task.urgent:
        return len(waiting)
    ahead = [i for i, other in enumerate(waiting) if other.urgent or task.since - other.since > FAIR]
    return max(ahead, default=-1) + 1


def start(
    executor: Any,
    function: Callable,
    args: tuple,
    on_progress: Optional[Callable] = None,
    time_limit: Optional[float] = None,
    urgent: bool = False,
) -> Future:
    """Start a call; an executor that is no pool of this package runs it to its end, without reports."""
    own = getattr(executor, "start", None)
    if own is None:
        return executor.submit(function, *args)
    return own(function, args, on_progress=on_progress, time_limit=time_limit, urgent=urgent)


def stop(task: Optional[Future], reason: str) -> None:
    """Stop a task, or cancel a future of another executor."""
    if isinstance(task, Task):
        task.stop(reason)
    elif task is not None:
        task.cancel()


def wait_for(task: Future, seconds: float, disconnected: Callable[[], bool]) -> object:
    """Return the result of a task, or stop it when it takes too long or nobody waits for it any more.

    Raises
    ------
    TimeoutError
        If it was stopped.
    """
    end = time.monotonic() + seconds
    try:
        while True:
            try:
                return task.result(timeout=min(POLL_INTERVAL, max(0.001, end - time.monotonic())))
            except FutureTimeout:
                if task.done():
                    raise
                late = time.monotonic() >= end
                if late or disconnected():
                    begun = task.running()
                    stop(task, "it took too long" if late else "the client is gone")
                    raise TimeoutError(("late" if begun else "queued") if late else "gone") from None
    finally:
        # The error of a task knows this frame: a circle, which would keep what the task was given for a long while.
        del task
