"""Background task: a function in a separate thread, so that the canvas is not blocked."""

from __future__ import annotations

import ctypes
import gc
import threading
import time
from collections.abc import Callable
from typing import Any
from typing import Generic
from typing import Optional
from typing import TypeVar

from ..._compiled import is_compiling
from .progress import Progress
from .progress import Report

__all__ = ["BackgroundTask"]

Result = TypeVar("Result")

CHECK_INTERVAL = 0.05  # time between two checks whether tasks are still needed [s]
GRACE = 0.4  # time between the request to stop and the interruption of a function that does not report [s]
GRACE_IF_REPLACED = 0.6  # the same for a task that is replaced by a newer one and has shown nothing yet [s]


class Interrupted(BaseException):
    """Raised in the thread of a cancelled task. It is no :class:`Exception`, so that functions do not handle it."""


class BackgroundTask(Generic[Result]):
    """A function that runs in a thread.

    A cancelled function ends at its next report. One that does not report is interrupted at its next line of Python.

    Parameters
    ----------
    function
        Function to run. Its argument is a callback that takes a :class:`Progress` and returns whether to stop.
    wanted
        Called from another thread; returns whether the result is still needed. Default: until the task is cancelled.
    after
        Task that ends before this one begins.

    Attributes
    ----------
    progress
        The latest progress.
    preview
        The latest intermediate outputs, or None.
    result
        Return value of the function, or None.
    error
        Error raised by the function, or None.
    """

    def __init__(
        self, function: Callable[[Report], Result], wanted: Callable[[], bool] = lambda: True, after: Optional[BackgroundTask] = None
    ):
        self.progress = Progress()
        self.preview: Any = None
        self.result: Optional[Result] = None
        self.error: Optional[Exception] = None
        self.cancelled = False
        self._stop = threading.Event()
        self._deadline = 0.0  # time of the interruption, once the task is cancelled
        self._preview_taken = True
        self._computing = False  # whether the thread can be interrupted
        self._interrupting = False  # whether another thread is about to interrupt it
        self._wanted = wanted
        self._after = after
        self._thread = threading.Thread(target=self._run, args=(function,), daemon=True)
        self._thread.start()
        _watch(self)

    @property
    def running(self) -> bool:
        """Whether the function is still running."""
        return self._thread.is_alive()

    def cancel(self, replaced: bool = False) -> None:
        """Request that the function stop, without waiting for it; a task that is `replaced` may show something first."""
        if not self._stop.is_set():
            grace = GRACE if not replaced else 0.0 if self.preview is not None else GRACE_IF_REPLACED
            self._deadline = time.monotonic() + grace
        self.cancelled = True
        self._stop.set()

    def wait(self, seconds: Optional[float]) -> bool:
        """Wait for the function, at most the given time [s], and return whether it has ended; None waits without a limit."""
        self._thread.join(seconds)
        return not self.running

    @property
    def has_preview(self) -> bool:
        """Whether there are intermediate outputs that :meth:`take_preview` has not returned."""
        return not self._preview_taken or (self._after is not None and self._after.has_preview)

    def take_preview(self) -> Any:
        """Return intermediate outputs that were not returned before, also of the task before this one, or None."""
        if self._preview_taken:
            return None if self._after is None else self._after.take_preview()
        taken, self._preview_taken = self.preview, True
        return taken

    def check(self) -> None:
        """Cancel a task that is not needed any more, and interrupt one that was cancelled and does not end."""
        if not self._stop.is_set():
            if not self._wanted():
                self.cancel()
        elif time.monotonic() > self._deadline:
            self._interrupting = True
            # Compilers are not interrupted, as they change the state of the process.
            if self._computing and not is_compiling(self._thread.ident or 0):
                _raise_in_thread(self._thread.ident, Interrupted)
            self._interrupting = False

    def _report(self, progress: Progress) -> bool:
        self.progress = progress
        # Of the surfaces after steps, only those are made that are shown.
        if progress.preview is not None and (self._preview_taken or not progress.step):
            self.preview = progress.preview()
            self._preview_taken = False
        return self._stop.is_set()

    def _run(self, function: Callable[[Report], Any]) -> None:
        self._computing = True
        try:
            try:
                self._compute(function)
            finally:
                self._refuse_interruptions()
        except Interrupted:  # also if it comes between the two lines above
            self._refuse_interruptions()

    def _compute(self, function: Callable[[Report], Any]) -> None:
        if self._after is not None:
            self._after.wait(None)
            self._after = self._after if self._after.has_preview else None
        if self._stop.is_set():
            return
        try:
            self.result = function(self._report)
        except Exception as error:  # shown on the canvas at the next poll
            self.error = error

    def _refuse_interruptions(self) -> None:
        """Wait for an interruption that is on its way, so that it reaches neither the end of this thread nor another thread.

        Identifiers of threads that have ended are used again. The two flags are a lock that an interruption cannot leave locked.
        """
        while True:
            try:
                self._computing = False
                while self._interrupting:
                    time.sleep(0.0)
                _raise_in_thread(threading.get_ident(), None)
                return
            except Interrupted:
                continue


def _raise_in_thread(thread: Optional[int], error: Optional[type[BaseException]]) -> None:
    """Raise an error at the next line of Python in a thread, or drop one that has not been raised yet if it is None."""
    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread or 0), None if error is None else ctypes.py_object(error))


_TASKS: list[BackgroundTask] = []
_CHANGE = threading.Lock()
_collects = True  # whether the garbage collector was enabled before


def _watch(task: BackgroundTask) -> None:
    """Check a task regularly until it ends.

    The garbage collector is disabled while tasks run, as a collection among the objects of large meshes blocks all threads. The
    thread that checks the tasks enables it again, because nothing interrupts that thread.
    """
    global _collects
    with _CHANGE:
        if not _TASKS:
            _collects = gc.isenabled()
            gc.disable()
            threading.Thread(target=_check_all, daemon=True).start()
        _TASKS.append(task)


def _check_all() -> None:
    while True:
        time.sleep(CHECK_INTERVAL)
        with _CHANGE:
            _TASKS[:] = [task for task in _TASKS if task.running]
            tasks = list(_TASKS)
            if not tasks:
                if _collects:
                    gc.enable()
                return
        for task in tasks:
            task.check()
