"""Threads that serve requests: as many as there are requests, each until there is none."""

from __future__ import annotations

import threading
from typing import Any

from waitress.task import ThreadedTaskDispatcher

__all__ = ["Threads"]


class Threads(ThreadedTaskDispatcher):
    """In the place of waitress's threads, which live as long as the server.

    The C library keeps small blocks that a thread freed for that thread, hundreds of kilobytes each, until it ends: the memory
    of a server of many threads would grow for minutes until all of them had had one of each size.

    Parameters
    ----------
    most
        Threads at a time, at least 1; requests beyond wait.
    """

    def __init__(self, most: int):
        super().__init__()
        self._most = most

    def add_task(self, task: Any) -> None:
        """Serve a request, or have it wait for a thread."""
        with self.lock:
            self.queue.append(task)
            if self.active_count == self._most:
                return
            self.active_count += 1
        try:
            threading.Thread(target=self._serve, name="request", daemon=True).start()
        except RuntimeError:
            # The system gives no more threads; the request is served after another, or after the next that gets one.
            with self.lock:
                self.active_count -= 1
            self.logger.exception("no thread for %r", task)

    def _serve(self) -> None:
        while True:
            with self.lock:
                if not self.queue:
                    self.active_count -= 1
                    self.thread_exit_cv.notify()
                    return
                task = self.queue.popleft()
            try:
                task.service()
            except BaseException:
                self.logger.exception("a request ended with %r", task)

    def shutdown(self, cancel_pending: bool = True, timeout: float = 5.0) -> bool:
        """Drop what waits, and give what is being served some seconds; tell whether anything was dropped."""
        with self.lock:
            dropped: list[Any] = list(self.queue) if cancel_pending else []
            if cancel_pending:
                self.queue.clear()
            self.thread_exit_cv.wait_for(lambda: not self.active_count, timeout)
        for task in dropped:
            task.cancel()
        return bool(dropped)
