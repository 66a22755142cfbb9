"""Handle of a worker process: the process, its pipe and its flag to stop."""

from __future__ import annotations

from multiprocessing import connection
from multiprocessing import process
from typing import Any

__all__ = ["WorkerHandle"]


class WorkerHandle:
    """The process that runs at the moment, the pipe to it, and its flag to stop.

    Parameters
    ----------
    urgent_only
        It is kept for tasks that somebody waits for.

    Attributes
    ----------
    state
        ``starting``, ``idle``, ``busy`` or ``closed``.
    """

    def __init__(self, urgent_only: bool = False) -> None:
        self.urgent_only = urgent_only
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

    def exit_message(self) -> str:
        """Say how the process ended."""
        code = self.process.exitcode
        how = f"killed by signal {-code}" if code is not None and code < 0 else f"exit code {code}"
        return f"the worker process of this job ended unexpectedly ({how}), perhaps for lack of memory; submit the job again"
