"""Reading of files with readable errors, and choice of their formats."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Union

from .._atomic_write import recover
from .._samples import no_file
from ..errors import FileError

__all__ = ["read_bytes", "suffix_among"]


def read_bytes(path: Path, most: int = -1) -> bytes:
    """Return the content of a file, or its first `most` bytes.

    Raises
    ------
    FileError
        If the file does not exist or cannot be read.
    """
    if path.is_dir():
        raise FileError(f"{path} is a folder; give the path of a file in it")
    recover(path.parent)
    try:
        with open(path, "rb") as file:
            return file.read(most)
    except FileNotFoundError:
        raise FileError(no_file(path)) from None
    except OSError as error:
        raise FileError(f"{path} cannot be read ({error.strerror})") from None


def suffix_among(path: Union[str, os.PathLike], suffixes: tuple[str, ...], what: str) -> str:
    """Return the longest matching suffix of a file, in lower case, such as ``.plan.svg``.

    Raises
    ------
    FileError
        If the suffix is not supported.
    """
    name = Path(path).name.lower()
    found = [suffix for suffix in suffixes if name.endswith(suffix) and name != suffix]
    if not found:
        own = Path(path).suffix.lower() or "a file without suffix"
        raise FileError(f"{path}: {what} are written to {', '.join(suffixes)}, not to {own!r}")
    return max(found, key=len)
