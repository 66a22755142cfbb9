"""Terminal: progress on one line, and Ctrl-C as a request to stop at the next step, so that the last good state is not lost."""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Callable
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING
from typing import Optional
from typing import TextIO

from .._compiled import watch_compilation

if TYPE_CHECKING:
    from .._compiled import Compilation
    from ..model.result import SolveState

__all__ = ["Parts", "ProgressBar", "compiling", "interruptible", "speaker"]

_WIDTH = 24
_INTERVAL = 0.1  # seconds between two pictures


def speaker(quiet: bool) -> Callable[[str], None]:
    """Return what tells the user a text; where the reader of a pipe has seen enough, the work goes on unsaid."""

    def say(text: str) -> None:
        try:
            print(text, flush=True)
        except OSError:
            sys.stdout = None

    return (lambda text: None) if quiet else say


def bar(part: float) -> str:
    """Return a bar that is filled so far, from 0 to 1."""
    filled = round(_WIDTH * min(1.0, max(0.0, part)))
    return "[" + "#" * filled + "." * (_WIDTH - filled) + "]"


@contextmanager
def compiling(quiet: bool = False, stream: Optional[TextIO] = None) -> Iterator[None]:
    """Show on one line, within a block, that kernels are compiled: a bar on a terminal, elsewhere a sentence.

    Parameters
    ----------
    quiet
        Show nothing.
    stream
        Where to. Default: standard error.
    """
    out = sys.stderr if stream is None else stream
    if quiet:
        yield
        return
    shown: list[str] = []

    def tell(state: Compilation) -> None:
        if out.isatty():
            text = f"{bar(state.part)} compiling, once: {state.seconds:.1f} s"
            out.write(f"\r{text}" if state.part < 1.0 else "\r" + " " * len(text) + "\r")
        elif not shown:
            out.write("compiling, once; this takes some seconds\n")
        shown.append("")
        out.flush()

    try:
        with watch_compilation(tell):
            yield
    finally:
        if shown and out.isatty():
            out.write("\r" + " " * 60 + "\r")
            out.flush()


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
        steps = f"step {state.step} of at most {state.steps}"
        text = f"{bar(state.step / state.steps)} {steps}, largest error {state.max_error:.3g}, {state.seconds:.1f} s"
        self.stream.write("\r" + text.ljust(self.length))
        self.stream.flush()
        self.length = len(text)

    def close(self) -> None:
        """Take the line away again."""
        if self.length:
            self.stream.write("\r" + " " * self.length + "\r")
            self.stream.flush()
            self.length = 0


class Parts:
    """Shows on one line which part of a command is at work, and for how long.

    Parameters
    ----------
    count
        How many parts there are.
    stream
        Where to; nothing is shown when it is not a terminal. Default: standard error.
    quiet
        Show nothing.
    """

    def __init__(self, count: int, stream: Optional[TextIO] = None, quiet: bool = False):
        self.count, self.done, self.quiet = count, 0, quiet
        self.stream = sys.stderr if stream is None else stream

    @contextmanager
    def part(self, text: str) -> Iterator[None]:
        """Show a part while it is at work, and take the line away again."""
        if self.quiet or not self.stream.isatty():
            yield
            return
        over = threading.Event()
        watch = threading.Thread(target=self._watch, args=(text, over), daemon=True)
        watch.start()
        try:
            yield
        finally:
            over.set()
            watch.join()
            self.done += 1

    def _watch(self, text: str, over: threading.Event) -> None:
        started, length = time.monotonic(), 0
        while not over.wait(_INTERVAL if length else 3 * _INTERVAL):
            line = f"{bar(self.done / self.count)} {text}: {time.monotonic() - started:.0f} s"
            self.stream.write("\r" + line.ljust(length))
            self.stream.flush()
            length = len(line)
        if length:
            self.stream.write("\r" + " " * length + "\r")
            self.stream.flush()


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
