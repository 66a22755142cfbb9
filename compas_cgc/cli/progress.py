"""A progress bar on a terminal, nothing in a pipe."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING
from typing import Optional
from typing import TextIO

if TYPE_CHECKING:
    from ..model.result import SolveState

__all__ = ["ProgressBar"]

WIDTH = 24
INTERVAL = 0.1  # seconds between two pictures


class ProgressBar:
    """A callback for solves that shows step and error on one line.

    Parameters
    ----------
    stream
        Where to; nothing is shown when it is not a terminal. Default: standard error.
    """

    def __init__(self, stream: Optional[TextIO] = None):
        self.stream = sys.stderr if stream is None else stream
        self.shown = 0.0
        self.length = 0

    def __call__(self, state: SolveState) -> None:
        """Show a state, at most ten times a second."""
        now = time.monotonic()
        if not self.stream.isatty() or now - self.shown < INTERVAL:
            return
        self.shown = now
        filled = round(WIDTH * state.step / state.steps)
        bar = "#" * filled + "." * (WIDTH - filled)
        text = f"[{bar}] step {state.step} of at most {state.steps}, largest error {state.max_error:.3g}, {state.seconds:.1f} s"
        self.stream.write("\r" + text.ljust(self.length))
        self.stream.flush()
        self.length = len(text)

    def close(self) -> None:
        """Take the line away again."""
        if self.length:
            self.stream.write("\r" + " " * self.length + "\r")
            self.stream.flush()
            self.length = 0
