"""Progress on one line of a terminal, and Ctrl-C as a request to stop at the next step."""

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

__all__ = ["Parts", "ProgressBar", "compiling", "interruptible", "printer"]

_WIDTH = 24
_INTERVAL = 0.1  # seconds between two updates


def printer(quiet: bool) -> Callable[[str], None]:
    """Return a function that prints a text; if the reader of a pipe closes it, later texts are dropped."""

    def echo(text: str) -> None:
        try:
            print(text, flush=True)
        except OSError:
            sys.stdout = None

    return (lambda text: None) if quiet else echo


def bar(part: float) -> str:
    """Return a progress bar for a fraction from 0 to 1."""
    filled = round(_WIDTH * min(1.0, max(0.0, part)))
    return "[" + "#" * filled + "." * (_WIDTH - filled) + "]"


@contextmanager
def compiling(quiet: bool = False, stream: Optional[TextIO] = None) -> Iterator[None]:
    """Show on one line that kernels are being compiled: a bar on a terminal, otherwise a sentence.

    Parameters
    ----------
    quiet
        Show nothing.
    stream
        Stream to write to. Default: standard error.
    """
    out = sys.stderr if stream is None else stream
    if quiet:
        yield
        return
    shown: list[str] = []

    def show(state: Compilation) -> None:
        if out.isatty():
            text = f"{bar(state.part)} compiling (first use only): {state.seconds:.1f} s"
            out.write(f"\r{text}" if state.part < 1.0 else "\r" + " " * len(text) + "\r")
        elif not shown:
            out.write("compiling (first use only); this takes some seconds\n")
        shown.append("")
        out.flush()

    try:
        with watch_compilation(show):
            yield
    finally:
        if shown and out.isatty():
            out.write("\r" + " " * 60 + "\r")
            out.flush()


class ProgressBar:
    """Callback of solves that shows step and error on one line.

    Parameters
    ----------
    stream
        Stream to write to; nothing is shown if it is not a terminal. Default: standard error.
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
        """Clear the line."""
        if self.length:
            self.stream.write("\r" + " " * self.length + "\r")
            self.stream.flush()
            self.length = 0


class Parts:
    """Shows on one line which part of a command runs, and for how long.

    Parameters
    ----------
    count
        Number of parts.
    stream
        Stream to write to; nothing is shown if it is not a terminal. Default: standard error.
    quiet
        Show nothing.
    """

    def __init__(self, count: int, stream: Optional[TextIO] = None, quiet: bool = False):
        self.count, self.done, self.quiet = count, 0, quiet
        self.stream = sys.stderr if stream is None else stream

    @contextmanager
    def part(self, text: str) -> Iterator[None]:
        """Show a part while it runs, then clear the line."""
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
    """Yield an event that is set by the first Ctrl-C; a second Ctrl-C interrupts as usual."""
    cancelled = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        # Python allows signal handlers in the main thread only.
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
