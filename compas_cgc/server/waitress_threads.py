"""Threads that serve requests: as many as there are requests, each until there is none."""

from __future__ import annotations

import logging
import threading
from collections import deque
from typing import Any

__all__ = ["Threads"]

_log = logging.getLogger("waitress")


class Threads:
    """In the place of waitress's threads, which live as long as the server.

    The C library keeps small blocks that a thread freed for that thread, hundreds of kilobytes each, until it ends: the memory
    of a server of many threads would grow for minutes until all of them had had one of each size.

    Parameters
    ----------
    most
        Threads at a time, at least 1; requests beyond wait.
    """

    def __init__(self, most: int):
        self._most = most
        self._tasks: deque[Any] = deque()
        self._running = 0
        self._lock = threading.Lock()
        self._ended = threading.Condition(self._lock)

    def add_task(self, task: Any) -> None:
        """Serve a request, or have it wait for a thread."""
        with self._lock:
            self._tasks.append(task)
            if self._running == self._most:
                return
            self._running += 1
        try:
            threading.Thread(target=self._serve, name="request", daemon=True).start()
        except RuntimeError:
            # The system gives no more threads; the request is served after another, or after the next that gets one.
            with self._lock:
                self._running -= 1
            _log.exception("no thread for %r", task)

    def _serve(self) -> None:
        while True:
            with self._lock:
                if not self._tasks:
                    self._running -= 1
                    self._ended.notify()
                    return
                task = self._tasks.popleft()
            try:
                task.service()
            except BaseException:
                _log.exception("a request ended with %r", task)

    def shutdown(self, cancel_pending: bool = True, timeout: float = 5.0) -> bool:
        """Drop what waits, and give what is being served some seconds; tell whether anything was dropped."""
        with self._lock:
            dropped = list(self._tasks) if cancel_pending else []
            if cancel_pending:
                self._tasks.clear()
            self._ended.wait_for(lambda: not self._running, timeout)
        for task in dropped:
            task.cancel()
        return bool(dropped)
