"""Progress of a rationalisation, and its cancellation."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple
from typing import Optional

__all__ = ["Progress", "Shown", "Stop", "Watch", "part_of"]


class Progress(NamedTuple):
    """State of a rationalisation."""

    done: int  # rounds
    rounds: int  # at most
    distance: float  # largest distance of the best surface so far [L]


Watch = Optional[Callable[[Progress], object]]
Shown = Callable[[int, int, float], bool]  # rounds done, rounds at most, largest distance [L]; true cancels


class Stop:
    """Callback of a rationalisation, and whether it has cancelled."""

    def __init__(self, callback: Watch):
        self._callback = callback
        self.stopped = False  # whether the callback cancelled

    def shown(self, done: int, rounds: int, distance: float) -> bool:
        """Call the callback with the state of the search; return whether to stop."""
        if self._callback is not None and not self.stopped:
            try:
                self.stopped = self._callback(Progress(done, rounds, distance)) is True
            except StopIteration:
                self.stopped = True
        return self.stopped


def part_of(shown: Shown, past: int, parts: int) -> Shown:
    """Return what shows the state of one of several equal parts, of which some are past."""
    return lambda done, rounds, distance: shown(past * rounds + done, parts * rounds, distance)
