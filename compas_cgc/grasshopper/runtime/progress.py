"""Progress of a solve, as the canvas shows it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple
from typing import Optional

__all__ = ["Progress", "ProgressMeter", "Report", "part_done"]

# Error against the largest target at which a surface is done to a designer's eye.
DONE = 1e-6
BAR = 10  # characters


class Progress(NamedTuple):
    """How far a solve has come."""

    step: int = 0
    max_error: Optional[float] = None  # largest |K - K̄| [1/L^2]
    part: float = 0.0  # done, from 0 to 1
    note: str = ""  # what it waits for
    compiling: Optional[float] = None  # part of the kernels that are compiled, while that is what it waits for

    def text(self) -> str:
        """Return how far it is, short enough for the line under a component."""
        if self.note:
            return "waiting"
        if self.compiling is not None:
            filled = round(BAR * self.compiling)
            return f"compiling, once [{'#' * filled}{'.' * (BAR - filled)}]"
        return f"step {self.step}" + ("" if self.max_error is None else f", error {self.max_error:.1e}")

    def measuring(self) -> str:
        """Return the same where no steps are taken."""
        return "measuring" if self.compiling is None else self.text()


Report = Callable[[Progress], bool]


class ProgressMeter:
    """Measures progress from the error of the first step that it sees to the goal.

    Parameters
    ----------
    scale
        Curvature that errors are small or large against [1/L^2].
    """

    def __init__(self, scale: float):
        self._goal = DONE * scale
        self._first: Optional[float] = None

    def at(self, step: int, max_error: float) -> Progress:
        """Return the progress at a step with its largest error [1/L^2]."""
        self._first = max_error if self._first is None else self._first
        return Progress(step, max_error, part_done(self._first, max_error, self._goal))


def part_done(first: float, error: float, goal: float) -> float:
    """Return how far an error has come from the first one to the goal, from 0 to 1 on a logarithmic scale."""
    if not goal < first or error >= first:
        return 0.0
    if error <= goal:
        return 1.0
    return math.log(first / error) / math.log(first / goal)
