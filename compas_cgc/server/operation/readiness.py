"""Readiness of a server, checked with a time limit."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from typing import Callable

__all__ = ["Readiness"]

PATIENCE = 3.0  # time after which a check counts as failed [s]
MAX_AGE = 1.0  # age up to which the last result is returned [s]; anybody may ask, and a check writes to the disk


class Readiness:
    """Result of a check that may block, for example because a disk does not respond.

    Parameters
    ----------
    check
        Returns the problems as sentences.
    patience
        Time after which a check counts as failed [s].
    max_age
        Age up to which the last result is returned [s].
    """

    def __init__(self, check: Callable[[], Sequence[str]], patience: float = PATIENCE, max_age: float = MAX_AGE):
        self._check, self._patience, self._max_age = check, patience, max_age
        self._change = threading.Condition()
        self._runs = False
        self._found: Sequence[str] = ()
        self._checked = -float("inf")

    def problems(self) -> Sequence[str]:
        """Return what keeps the server from accepting jobs as sentences, nothing if it is ready; responds within the patience."""
        with self._change:
            asked = time.monotonic()
            if asked - self._checked > self._max_age:
                if not self._runs:
                    self._runs = True
                    threading.Thread(target=self._run, name="readiness", daemon=True).start()
                if not self._change.wait_for(lambda: self._checked >= asked, self._patience):
                    return [f"the store did not respond within {self._patience:g} s"]
            return self._found

    def _run(self) -> None:
        try:
            found = self._check()
        except Exception as error:
            found = [f"the check failed ({error})"]
        with self._change:
            self._found, self._checked, self._runs = found, time.monotonic(), False
            self._change.notify_all()
