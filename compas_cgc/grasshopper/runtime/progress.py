"""Progress of a solve, for display on the canvas."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any
from typing import NamedTuple
from typing import Optional

__all__ = ["Progress", "ProgressMeter", "Report", "part_done"]

# Error relative to the largest target at which the progress is complete.
DONE = 1e-6
BAR = 10  # length of the progress bar [characters]


class Progress(NamedTuple):
    """Progress of a solve."""

    step: int = 0
    max_error: Optional[float] = None  # largest |K - K̄| [1/L^2]
    part: float = 0.0  # completed fraction, from 0 to 1
    note: str = ""  # what the solve is waiting for
    compiling: Optional[float] = None  # compiled fraction of the kernels, during compilation
    task: str = ""  # name of the task, if it has no steps
    preview: Optional[Callable[[], Any]] = None  # makes intermediate outputs

    def text(self) -> str:
        """Return a text short enough for the line below a component."""
        if self.note:
            return "waiting"
        if self.compiling is not None:
            filled = round(BAR * self.compiling)
            return f"compiling (first use) [{'#' * filled}{'.' * (BAR - filled)}]"
        if self.task:
            return self.task
        return f"step {self.step}" + ("" if self.max_error is None else f", error {self.max_error:.1e}")


Report = Callable[[Progress], bool]


class ProgressMeter:
    """Measures progress on a logarithmic scale from the first error to the final error.

    Parameters
    ----------
    scale
        Reference curvature for errors [1/L^2].
    """

    def __init__(self, scale: float):
        self._goal = DONE * scale
        self._first: Optional[float] = None

    def at(self, step: int, max_error: float) -> Progress:
        """Return the progress at a step with a given largest error [1/L^2]."""
        self._first = max_error if self._first is None else self._first
        return Progress(step, max_error, part_done(self._first, max_error, self._goal))


def part_done(first: float, error: float, goal: float) -> float:
    """Return the completed fraction (0 to 1) of the decrease from the first error to the goal, on a logarithmic scale."""
    if not goal < first or error >= first:
        return 0.0
    if error <= goal:
        return 1.0
    return math.log(first / error) / math.log(first / goal)
