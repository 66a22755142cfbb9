"""Threads that serve requests: started on demand, ended when no request is waiting."""

from __future__ import annotations

import threading
import time
from typing import Any

from waitress.task import ThreadedTaskDispatcher

__all__ = ["Threads"]


class Threads(ThreadedTaskDispatcher):
    """Thread dispatcher that replaces the permanent threads of waitress.

    The C library keeps freed blocks (hundreds of kilobytes) for each thread until the thread ends, so the memory of a server with
    many permanent threads would grow for minutes.

    Parameters
    ----------
    most
        Largest number of threads, at least 1; further requests wait.
    """

    def __init__(self, most: int):
        super().__init__()
        self._most = most

    def add_task(self, task: Any) -> None:
        """Serve a request in a thread, or queue it."""
        task.queued_at = time.monotonic()
        with self.lock:
            self.queue.append(task)
            if self.active_count == self._most:
                return
            self.active_count += 1
        try:
            threading.Thread(target=self._serve, name="request", daemon=True).start()
        except RuntimeError:
            # The system cannot start a thread; the request stays queued for the next free thread.
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
        """Drop queued requests and wait `timeout` seconds for those being served; return whether any were dropped."""
        with self.lock:
            dropped: list[Any] = list(self.queue) if cancel_pending else []
            if cancel_pending:
                self.queue.clear()
            self.thread_exit_cv.wait_for(lambda: not self.active_count, timeout)
        for task in dropped:
            task.cancel()
        return bool(dropped)
