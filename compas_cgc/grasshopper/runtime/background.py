"""Background task: a function in a separate thread, so that the canvas is not blocked."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any
from typing import Generic
from typing import Optional
from typing import TypeVar

from .progress import Progress
from .progress import Report

__all__ = ["BackgroundTask"]

Result = TypeVar("Result")


class BackgroundTask(Generic[Result]):
    """A function that runs in a thread.

    Parameters
    ----------
    function
        Function to run. Its argument is a callback that takes a :class:`Progress` and returns whether to stop.
    wanted
        Called in the thread; returns whether the result is still needed. Default: until the task is cancelled.

    Attributes
    ----------
    progress
        The latest progress.
    result
        Return value of the function, or None.
    error
        Error raised by the function, or None.
    """

    def __init__(self, function: Callable[[Report], Result], wanted: Callable[[], bool] = lambda: True):
        self.progress = Progress()
        self.result: Optional[Result] = None
        self.error: Optional[Exception] = None
        self._stop = threading.Event()
        self._wanted = wanted
        self._thread = threading.Thread(target=self._run, args=(function,), daemon=True)
        self._thread.start()

    @property
    def running(self) -> bool:
        """Whether the function is still running."""
        return self._thread.is_alive()

    def cancel(self) -> None:
        """Request that the function stop, without waiting for it."""
        self._stop.set()

    def wait(self, seconds: Optional[float]) -> bool:
        """Wait for the function, at most the given time [s], and return whether it has ended; None waits without a limit."""
        self._thread.join(seconds)
        return not self.running

    def _report(self, progress: Progress) -> bool:
        self.progress = progress
        return self._stop.is_set() or not self._wanted()

    def _run(self, function: Callable[[Report], Any]) -> None:
        try:
            self.result = function(self._report)
        except Exception as error:  # shown on the canvas at the next poll
            self.error = error
