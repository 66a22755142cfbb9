"""Files on the disk: whole or not there, with errors in words."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Union

from .._atomic_write import recover
from .._atomic_write import replacing
from .._samples import no_file
from ..errors import FileError

__all__ = ["read_bytes", "suffix_among", "written"]


def read_bytes(path: Path, most: int = -1) -> bytes:
    """Return the content of a file, or its first `most` bytes.

    Raises
    ------
    FileError
        If there is no such file or it cannot be read.
    """
    if path.is_dir():
        raise FileError(f"{path} is a folder; give a file in it")
    recover(path.parent)
    try:
        with open(path, "rb") as file:
            return file.read(most)
    except FileNotFoundError:
        raise FileError(no_file(path)) from None
    except OSError as error:
        raise FileError(f"{path} cannot be read ({error.strerror})") from None


@contextmanager
def written(path: Union[str, os.PathLike]) -> Iterator[Path]:
    """Give the name of a temporary file beside `path`, and put it in its place when the block ends well.

    Raises
    ------
    FileError
        If the disk, the folder or the permissions do not allow it; the older file is as it was.
    """
    if os.path.isdir(path):
        raise FileError(f"{path} is a folder; give the name of a file in it")
    try:
        with replacing(path) as temporary:
            yield temporary
    except OSError as error:
        reason = error.strerror or str(error)
        raise FileError(f"{path} cannot be written ({reason}); close it elsewhere, or choose another name or folder") from None


def suffix_among(path: Union[str, os.PathLike], suffixes: tuple[str, ...], what: str) -> str:
    """Return the suffix of a file in small letters if it is among others, the longest of these, such as ``.plan.svg``.

    Raises
    ------
    FileError
        If it is not.
    """
    name = Path(path).name.lower()
    found = [suffix for suffix in suffixes if name.endswith(suffix) and name != suffix]
    if not found:
        own = Path(path).suffix.lower() or "a file without suffix"
        raise FileError(f"{path}: {what} are written to {', '.join(suffixes)}, not to {own!r}")
    return max(found, key=len)
