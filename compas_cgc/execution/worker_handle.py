"""Handle of a worker process: process, pipe and stop flag."""

from __future__ import annotations

import os
import time
from multiprocessing import connection
from multiprocessing import process
from pathlib import Path
from typing import Any
from typing import Optional

from .future import Task
from .lanes import ANY

__all__ = ["WorkerHandle"]

_PAGE = os.sysconf("SC_PAGE_SIZE") if hasattr(os, "sysconf") else 4096  # bytes


class WorkerHandle:
    """The current worker process, its pipe and its stop flag.

    Parameters
    ----------
    lane
        Which tasks it takes, see :mod:`~compas_cgc.execution.lanes`.

    Attributes
    ----------
    state
        ``starting``, ``idle``, ``busy`` or ``closed``.
    """

    def __init__(self, lane: str = ANY) -> None:
        self.lane = lane
        self.task: Optional[Task] = None
        self.state = "starting"
        self.process: process.BaseProcess = None  # type: ignore[assignment]  # until it is started
        self.line: connection.Connection = None  # type: ignore[assignment]
        self.flag: Any = None

    def end(self) -> None:
        """End the process by force and close the pipe."""
        if self.process is not None and self.process.is_alive():
            self.process.terminate()
            self.process.join(0.3)
            if self.process.is_alive():
                self.process.kill()
                self.process.join()
        if self.line is not None:
            self.line.close()

    def resident(self) -> int:
        """Return the bytes of memory that the process holds, 0 where the system does not tell."""
        try:
            return int(Path(f"/proc/{self.process.pid}/statm").read_text().split()[1]) * _PAGE
        except (OSError, IndexError, ValueError):
            return 0

    def clock(self) -> float:
        """Return a time [s] that stands still while the process is ready, but other processes have the processors.

        On a busy machine, a process gets no less of this time. Where the system does not report the delays, it is the usual time.
        """
        return time.monotonic() - self._scheduled()[1]

    def used(self) -> Optional[float]:
        """Return the seconds for which the process had a processor, None where this is not reported."""
        return self._scheduled()[0]

    def _scheduled(self) -> tuple[Optional[float], float]:
        try:
            ran, waited = Path(f"/proc/{self.process.pid}/schedstat").read_text().split()[:2]
            return int(ran) * 1e-9, int(waited) * 1e-9
        except (OSError, ValueError):
            return None, 0.0

    def exit_message(self) -> str:
        """Return a message on how the process ended."""
        code = self.process.exitcode
        how = f"killed by signal {-code}" if code is not None and code < 0 else f"exit code {code}"
        return f"the worker process of this job ended unexpectedly ({how}), probably for lack of memory; submit the job again"
