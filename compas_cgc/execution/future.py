"""Futures of calls in worker processes."""

from __future__ import annotations

import time
from collections.abc import Sequence
from concurrent.futures import Future
from concurrent.futures import TimeoutError as FutureTimeout
from typing import Any
from typing import Callable
from typing import Optional
from typing import Union

__all__ = ["Arguments", "LimitExceeded", "Task", "TaskError", "TaskStopped", "WorkerDied", "place", "start", "stop", "wait_for"]

POLL_INTERVAL = 0.1  # time between two checks whether the client is still connected [s]
MAX_OVERTAKEN = 5.0  # waiting time after which urgent tasks no longer overtake a task [s]
GRACE = 0.15  # time that a client waits for a task after a stop request [s]


Arguments = Union[tuple, Callable[[], tuple]]
"""Arguments of a call, or a function that fetches them when a worker takes the task."""


class WorkerDied(RuntimeError):
    """The worker process ended during the task."""


class TaskStopped(RuntimeError):
    """A task was ended by force: it did not stop within the grace period."""


class LimitExceeded(TaskStopped):
    """A task was ended by force: it took more time or memory than it may."""


class TaskError(RuntimeError):
    """A task raised an exception.

    Attributes
    ----------
    kind
        Name of its class.
    trace
        The worker's traceback.
    status
        HTTP status of the error, None for an error in the program.
    """

    def __init__(self, kind: str, text: str, trace: str, status: Optional[int] = None):
        super().__init__(text)
        self.kind = kind
        self.trace = trace
        self.status = status


class Task(Future):
    """A future with progress reports that can be stopped while it runs.

    Attributes
    ----------
    on_progress
        Called with every progress report.
    stop_reason
        Reason of the stop request, None if there was none.
    urgent
        Whether a client waits for it, which gives it priority in the queue.
    client
        Name of the client; workers are shared among clients.
    memory_limit
        Largest memory of its process [bytes]; beyond it the process is ended.
    alike
        Name of the calls that are expected to take about as long. Default: the client.
    since
        Submission time.
    on_late
        Called with a result that arrives after the task was reported as stopped.
    grace
        Further time in which the task may still end by itself before its worker is killed [s].
    """

    def __init__(
        self,
        call: tuple,
        on_progress: Optional[Callable[[object], object]],
        time_limit: Optional[float],
        urgent: bool = False,
        client: str = "",
        memory_limit: Optional[int] = None,
        alike: str = "",
    ):
        super().__init__()
        self.call: Optional[tuple] = call  # released once it is sent
        self.client = client
        self.memory_limit = memory_limit
        self.alike = alike or client
        self.long = False  # known to take longer than a short call
        self.on_progress = on_progress
        self.time_limit = time_limit
        self.on_late: Optional[Callable[[Any], object]] = None
        self.stop_reason: Optional[str] = None
        self.exceeded = False  # whether it is stopped for a limit
        self.stop_time = 0.0
        self.grace = GRACE
        self.urgent = urgent
        self.since = time.monotonic()

    def prepared(self) -> tuple:
        """Return function, arguments and keyword arguments; what is fetched only now did not take memory while the task waited."""
        assert self.call is not None
        function, args, kwargs = self.call
        return function, args() if callable(args) else args, kwargs

    def stop(self, reason: str = "cancelled", grace: float = GRACE, exceeded: bool = False) -> None:
        """Cancel a queued task, or request that a running task stop."""
        if not self.cancel() and self.stop_reason is None:
            self.stop_time = time.monotonic()
            self.grace = grace
            self.exceeded = exceeded
            self.stop_reason = reason

    def stopped(self) -> TaskStopped:
        """Return the exception of a task that was asked to stop and did not."""
        return (LimitExceeded if self.exceeded else TaskStopped)(self.stop_reason)


def place(task: Task, waiting: Sequence[Task]) -> int:
    """Return the position of a task in a queue; urgent tasks overtake tasks that have not waited long."""
    if not task.urgent:
        return len(waiting)
    ahead = [i for i, other in enumerate(waiting) if other.urgent or task.since - other.since > MAX_OVERTAKEN]
    return max(ahead, default=-1) + 1


def start(
    executor: Any,
    function: Callable,
    args: Arguments,
    on_progress: Optional[Callable] = None,
    time_limit: Optional[float] = None,
    urgent: bool = False,
    client: str = "",
    memory_limit: Optional[int] = None,
    alike: str = "",
) -> Future:
    """Start a call; a plain executor runs it without reports, and it cannot be stopped."""
    own = getattr(executor, "start", None)
    if own is None:
        return executor.submit(function, *(args() if callable(args) else args))
    limits = {"time_limit": time_limit, "memory_limit": memory_limit}
    return own(function, args, on_progress=on_progress, urgent=urgent, client=client, alike=alike, **limits)


def stop(task: Optional[Future], reason: str) -> None:
    """Stop a task, or cancel a future of another executor."""
    if isinstance(task, Task):
        task.stop(reason)
    elif task is not None:
        task.cancel()


def wait_for(task: Future, seconds: float, disconnected: Callable[[], bool]) -> object:
    """Return the result of a task, or stop it when the time limit is exceeded or the client has disconnected.

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
                    stop(task, "it exceeded its time limit" if late else "the client disconnected")
                    raise TimeoutError(("late" if begun else "queued") if late else "gone") from None
    finally:
        # Break the reference cycle between the error of the task and this frame, which would keep the arguments in memory.
        del task
