"""Progress of a rationalisation, and its cancellation."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple
from typing import Optional

__all__ = ["Progress", "Stop", "Watch"]


class Progress(NamedTuple):
    """How far a rationalisation is."""

    done: int  # rounds
    rounds: int  # at most
    distance: float  # largest distance of the best surface so far [L]


Watch = Optional[Callable[[Progress], object]]


class Stop:
    """Shows progress to a callback, and remembers whether it cancelled."""

    def __init__(self, callback: Watch, searches: int):
        self._callback, self._searches = callback, searches
        self.past, self.stopped = 0, False  # searches that are done

    def shown(self, done: int, rounds: int, distance: float) -> bool:
        """Show how far the search is; return whether to stop."""
        if self._callback is not None and not self.stopped:
            try:
                self.stopped = self._callback(Progress(self.past * rounds + done, self._searches * rounds, distance)) is True
            except StopIteration:
                self.stopped = True
        return self.stopped
