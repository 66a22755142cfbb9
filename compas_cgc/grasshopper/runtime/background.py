"""Work in the background, so that a canvas never waits."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic
from typing import NamedTuple
from typing import Optional
from typing import TypeVar

__all__ = ["Progress", "Work"]

Outcome = TypeVar("Outcome")


class Progress(NamedTuple):
    """How far a solve has come."""

    step: int = 0
    max_error: Optional[float] = None  # largest |K - K̄| [1/L^2]
    part: float = 0.0  # done, from 0 to 1
    note: str = ""  # what it waits for


class Work(Generic[Outcome]):
    """A function that runs in a thread of its own.

    Parameters
    ----------
    function
        Called with a function that takes a :class:`Progress` and returns whether the
        work shall stop; returns the outcome.

    Attributes
    ----------
    progress
        The latest progress.
    outcome
        What the function returned, or None.
    refusal
        What it raised, or None.
    """

    def __init__(self, function: Callable[[Callable[[Progress], bool]], Outcome]):
        self.progress = Progress()
        self.outcome: Optional[Outcome] = None
        self.refusal: Optional[Exception] = None
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, args=(function,), daemon=True)
        self._thread.start()

    @property
    def running(self) -> bool:
        """Whether the outcome is still to come."""
        return self._thread.is_alive()

    def cancel(self) -> None:
        """Ask the function to stop, without waiting for it."""
        self._stop.set()

    def wait(self, seconds: float) -> bool:
        """Wait for the function, at most so long, and tell whether it has ended."""
        self._thread.join(seconds)
        return not self.running

    def _tell(self, progress: Progress) -> bool:
        self.progress = progress
        return self._stop.is_set()

    def _run(self, function: Callable) -> None:
        try:
            self.outcome = function(self._tell)
        except Exception as refusal:  # the thread has no one else to tell
            self.refusal = refusal
