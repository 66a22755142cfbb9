"""Calls: functions that a request waits for, counted apart from the jobs."""

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
    """Calls on the executors of a server.

    Parameters
    ----------
    executor
        Runs the solves.
    io_pool
        Reads and writes files.
    limits
        How many may wait, and how long.
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
            What to run.
        disconnected
            Tells whether the client has given up, which stops the function.

        Raises
        ------
        Busy
            If too many calls wait.
        TimeoutError
            If it took longer than the limit for requests that wait.
        """
        # Somebody waits for it, as nobody does for a job.
        return self._waited(self.executor, self._calls, "other solves", function, args, disconnected)

    def convert(self, function: Callable, *args: object, disconnected: Callable[[], bool] = lambda: False) -> object:
        """Run a function that reads or writes a file and wait for it, as :meth:`call` does; no solve is waited for."""
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
            raise Busy(f"the server is busy with {others}; try again in a moment")
        try:
            with self._lock:
                if self._closed:
                    raise ServerStopping("the server is stopping; ask again when it is back")
                started = [start(executor, function, args, time_limit=self.limits.seconds, urgent=True)]
            # This frame does not know the task, whose error will know the frame: a circle would keep the arguments for a long while.
            return wait_for(started.pop(), self.limits.blocking, disconnected)
        finally:
            slots.release()

    def close(self) -> None:
        """Take no more calls."""
        with self._lock:
            self._closed = True
