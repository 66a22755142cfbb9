"""Handle of a worker process: process, pipe and stop flag."""

from __future__ import annotations

from multiprocessing import connection
from multiprocessing import process
from typing import Any

__all__ = ["WorkerHandle"]


class WorkerHandle:
    """The current worker process, its pipe and its stop flag.

    Parameters
    ----------
    urgent_only
        Whether the worker runs urgent tasks only.

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
        """Return a message on how the process ended."""
        code = self.process.exitcode
        how = f"killed by signal {-code}" if code is not None and code < 0 else f"exit code {code}"
        return f"the worker process of this job ended unexpectedly ({how}), probably for lack of memory; submit the job again"
