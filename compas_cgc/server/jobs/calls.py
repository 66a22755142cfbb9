"""Blocking calls: functions that a request waits for. They have their own limit, separate from the jobs."""

from __future__ import annotations

import threading
from typing import Callable

from ...execution.future import start
from ...execution.future import wait_for
from ...execution.protocol import AnyExecutor
from ..errors import Busy
from ..errors import ServerStopping
from ..limits import Limits

__all__ = ["Calls"]


class Calls:
    """Blocking calls on the executors of a server.

    Parameters
    ----------
    executor
        Runs the solves.
    io_pool
        Reads and writes files.
    limits
        Limits on the number of waiting calls and on their duration.
    """

    def __init__(self, executor: AnyExecutor, io_pool: AnyExecutor, limits: Limits):
        self.executor = executor
        self.io_pool = io_pool
        self.limits = limits
        self._calls = threading.BoundedSemaphore(limits.calls)
        self._conversions = threading.BoundedSemaphore(limits.conversions)
        self._lock = threading.Lock()
        self._closed = False

    def call(self, function: Callable, *args: object, disconnected: Callable[[], bool] = lambda: False) -> object:
        """Run a function in a worker and wait for it.

        Parameters
        ----------
        function, args
            The function and its arguments.
        disconnected
            Returns whether the client has disconnected. The function is then stopped.

        Raises
        ------
        Busy
            If too many calls wait.
        TimeoutError
            If the call exceeded its time limit.
        """
        # A client waits for this call, unlike for a job.
        return self._waited(self.executor, self._calls, "other solves", function, args, disconnected)

    def convert(self, function: Callable, *args: object, disconnected: Callable[[], bool] = lambda: False) -> object:
        """Run a function that reads or writes a file and wait for it, as :meth:`call` does, but without queueing behind solves."""
        return self._waited(self.io_pool, self._conversions, "other files", function, args, disconnected)

    def _waited(
        self,
        executor: AnyExecutor,
        slots: threading.BoundedSemaphore,
        others: str,
        function: Callable,
        args: tuple,
        disconnected: Callable[[], bool],
    ) -> object:
        if not slots.acquire(blocking=False):
            raise Busy(f"the server is busy with {others}; try again in a few seconds")
        try:
            with self._lock:
                if self._closed:
                    raise ServerStopping("the server is shutting down; try again after it has restarted")
                started = [start(executor, function, args, time_limit=self.limits.seconds, urgent=True)]
            # Drop the reference to the task: its error refers to this frame, and the cycle would keep the arguments in memory.
            return wait_for(started.pop(), self.limits.blocking, disconnected)
        finally:
            slots.release()

    def close(self) -> None:
        """Reject further calls."""
        with self._lock:
            self._closed = True
