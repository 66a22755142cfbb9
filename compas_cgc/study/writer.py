"""Lock of the folder of a study for one writer, and handling of damaged files."""

from __future__ import annotations

import logging
import os
import sqlite3
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Callable

from ..errors import FileError

__all__ = ["one_writer", "set_aside"]

LOCK = ".writer"
POLL_INTERVAL = 0.1  # time between two attempts to lock the folder [s]

log = logging.getLogger(__name__)


@contextmanager
def one_writer(folder: Path, stopped: Callable[[], bool]) -> Iterator[bool]:
    """Lock a folder for this process within a block, after waiting for other processes; the lock ends with the process.

    Parameters
    ----------
    folder
        Of the study.
    stopped
        Called while another process holds the folder; True gives up.

    Yields
    ------
    bool
        Whether the folder is held.

    Raises
    ------
    FileError
        If the folder cannot be written to.
    """
    try:
        lock = sqlite3.connect(folder / LOCK, timeout=0.0, isolation_level=None)
    except sqlite3.Error as error:
        raise FileError(f"{folder} is not writable ({error}); choose another folder") from None
    try:
        held = False
        while not held:
            try:
                lock.execute("BEGIN EXCLUSIVE")
                held = True
            except sqlite3.OperationalError as error:
                if "locked" not in str(error):
                    raise FileError(f"{folder} is not writable ({error}); choose another folder") from None
                if stopped():
                    break
                time.sleep(POLL_INTERVAL)
        yield held
    finally:
        lock.close()


def set_aside(path: Path) -> None:
    """Rename a damaged file, so that another can be written in its place."""
    if path.exists():
        log.warning("%s is damaged; it is renamed to %s.damaged, and computed again", path, path.name)
        os.replace(path, path.with_name(f"{path.name}.damaged"))
