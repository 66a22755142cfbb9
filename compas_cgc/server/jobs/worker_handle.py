"""A place for a worker process."""

from __future__ import annotations

from multiprocessing import connection
from multiprocessing import process
from typing import Optional

__all__ = ["Slot"]


class Slot:
    """The process that is there at the moment, the line to it, and its flag to stop.

    Attributes
    ----------
    state
        ``starting``, ``idle``, ``busy`` or ``closed``.
    """

    def __init__(self) -> None:
        self.state = "starting"
        self.process: Optional[process.BaseProcess] = None
        self.line: Optional[connection.Connection] = None
        self.flag: Optional[object] = None

    def end(self) -> None:
        """End the process by force and let go of the line."""
        if self.process is not None and self.process.is_alive():
            self.process.terminate()
            self.process.join(0.3)
            if self.process.is_alive():
                self.process.kill()
                self.process.join()
        if self.line is not None:
            self.line.close()

    def obituary(self) -> str:
        """Say how the process ended."""
        code = self.process.exitcode
        how = f"killed by signal {-code}" if code is not None and code < 0 else f"exit code {code}"
        return f"the worker process of this job ended unexpectedly ({how}), perhaps for lack of memory; submit the job again"
