"""Files that are whole or not there, with errors in words."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Union

from .._atomic_write import replacing
from ..errors import FileError

__all__ = ["written"]


@contextmanager
def written(path: Union[str, os.PathLike]) -> Iterator[Path]:
    """Give the name of a new file beside `path`, and put it in its place when the block ends well.

    Raises
    ------
    FileError
        If the disk, the folder or the permissions do not allow it; the older file is as it was.
    """
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise FileError(f"{path} is a folder; give the name of a file in it")
    try:
        with replacing(target) as beside:
            yield beside
            # The new content is on the disk before the old name points to it.
            with open(beside, "r+b") as file:
                os.fsync(file.fileno())
    except OSError as error:
        reason = error.strerror or str(error)
        raise FileError(f"{path} cannot be written ({reason}); close it elsewhere, or choose another name or folder") from None
