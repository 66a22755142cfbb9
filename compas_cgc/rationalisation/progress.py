"""Progress of a rationalisation, and its cancellation."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple
from typing import Optional

__all__ = ["Progress", "Stop", "Watch"]


class Progress(NamedTuple):
    """State of a rationalisation."""

    done: int  # rounds
    rounds: int  # at most
    distance: float  # largest distance of the best surface so far [L]


Watch = Optional[Callable[[Progress], object]]


class Stop:
    """Callback of a rationalisation, and whether it has cancelled."""

    def __init__(self, callback: Watch, searches: int):
        self._callback, self._searches = callback, searches
        self.past, self.stopped = 0, False  # completed searches, and whether the callback cancelled

    def shown(self, done: int, rounds: int, distance: float) -> bool:
        """Call the callback with the state of the search; return whether to stop."""
        if self._callback is not None and not self.stopped:
            try:
                self.stopped = self._callback(Progress(self.past * rounds + done, self._searches * rounds, distance)) is True
            except StopIteration:
                self.stopped = True
        return self.stopped
