"""Blocking calls: functions that a request waits for. They have their own limit, separate from the jobs."""

from __future__ import annotations

import threading
from typing import Callable
from typing import Optional

from ...execution.future import TaskStopped
from ...execution.future import start
from ...execution.future import wait_for
from ...execution.protocol import AnyExecutor
from ..errors import Busy
from ..errors import ServerStopping
from ..limits import Limits
from .shares import Shares

__all__ = ["Calls"]

STOPPING = "the server is shutting down; try again after it has restarted"


class Calls:
    """Calls on the executors of a server.

    Parameters
    ----------
    executor
        Runs the solves.
    readers, writers
        Read the files of clients, and write files for them.
    limits
        Limits on the number of waiting calls and on their duration.
    """

    def __init__(self, executor: AnyExecutor, readers: AnyExecutor, writers: AnyExecutor, limits: Limits):
        self.executor, self.readers, self.writers = executor, readers, writers
        self.limits = limits
        self.slots = {
            name: Shares(count) for name, count in (("calls", limits.calls), ("read", limits.conversions), ("write", limits.conversions))
        }
        self._lock = threading.Lock()
        self._closed = False

    def call(
        self,
        function: Callable,
        *args: object,
        client: str = "",
        disconnected: Callable[[], bool] = lambda: False,
        alike: str = "",
    ) -> object:
        """Run a function in a worker and wait for it.

        Parameters
        ----------
        function, args
            The function and its arguments.
        client
            Who asks.
        disconnected
            Returns whether the client has disconnected. The function is then stopped.
        alike
            Which calls of this client are expected to take about as long.

        Raises
        ------
        Busy
            If too many calls wait, of this client or in all.
        TimeoutError
            If the call exceeded its time limit.
        """
        # A client waits for this call, unlike for a job.
        return self._waited(
            self.executor, "calls", "other solves", function, args, client, disconnected, self.limits.seconds, self.limits.memory, alike
        )

    def read(self, function: Callable, *args: object, client: str = "", disconnected: Callable[[], bool] = lambda: False) -> object:
        """Run a function that reads what a client sent, in a process with limits of its own, as :meth:`call` does."""
        limits = self.limits
        return self._waited(
            self.readers, "read", "other files", function, args, client, disconnected, limits.file_seconds, limits.file_memory
        )

    def write(self, function: Callable, *args: object, client: str = "", disconnected: Callable[[], bool] = lambda: False) -> object:
        """Run a function that writes a result as a file, as :meth:`call` does; it never waits for files that are read."""
        return self._waited(
            self.writers, "write", "other files", function, args, client, disconnected, self.limits.seconds, self.limits.memory
        )

    def _waited(
        self,
        executor: AnyExecutor,
        kind: str,
        others: str,
        function: Callable,
        args: tuple,
        client: str,
        disconnected: Callable[[], bool],
        seconds: float,
        memory: Optional[int],
        alike: str = "",
    ) -> object:
        slots = self.slots[kind]
        if not slots.acquire(client):
            raise Busy(f"the server is busy with {others}; try again in a few seconds")
        try:
            with self._lock:
                if self._closed:
                    raise ServerStopping(STOPPING)
                name = f"{client} {alike}"
                started = [start(executor, function, args, None, seconds, urgent=True, client=client, memory_limit=memory, alike=name)]
            # Drop the reference to the task: its error refers to this frame, and the cycle would keep the arguments in memory.
            return wait_for(started.pop(), self.limits.blocking, disconnected)
        except TaskStopped:
            if self._closed:
                raise ServerStopping(STOPPING) from None
            raise
        finally:
            slots.release(client)

    def close(self) -> None:
        """Reject further calls."""
        with self._lock:
            self._closed = True
