"""Terminal: progress on one line, and Ctrl-C as a request to stop at the next step, so that the last good state is not lost."""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING
from typing import Optional
from typing import TextIO

if TYPE_CHECKING:
    from ..model.result import SolveState

__all__ = ["ProgressBar", "interruptible"]

_WIDTH = 24
_INTERVAL = 0.1  # seconds between two pictures


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
        if not self.stream.isatty() or now - self.shown < _INTERVAL:
            return
        self.shown = now
        filled = round(_WIDTH * state.step / state.steps)
        bar = "#" * filled + "." * (_WIDTH - filled)
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


@contextmanager
def interruptible() -> Iterator[threading.Event]:
    """Yield an event that the first Ctrl-C sets; the second one interrupts as usual."""
    cancelled = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        # Only the main thread may handle signals.
        yield cancelled
        return

    def handle(number: int, frame: object) -> None:
        if cancelled.is_set():
            raise KeyboardInterrupt
        cancelled.set()

    before = signal.signal(signal.SIGINT, handle)
    try:
        yield cancelled
    finally:
        signal.signal(signal.SIGINT, before)
