"""Atomic writes: a file is written to a temporary one temporary it, which then takes its place."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Union

__all__ = ["replacing", "write_text"]

# The mask can be read by setting it only, which is not safe when threads write files.
_UMASK = os.umask(0)
os.umask(_UMASK)


@contextmanager
def replacing(path: Union[str, Path]) -> Iterator[Path]:
    """Give the name of a temporary file beside `path`, and put it in its place when the block ends well.

    When the block raises, the temporary file is removed and what was at `path` is left alone.
    It has the suffix of `path`, for writers that go by it.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent)
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        if path.exists():
            os.chmod(temporary, path.stat().st_mode)
        else:
            os.chmod(temporary, 0o666 & ~_UMASK)
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def write_text(path: Union[str, Path], text: str) -> None:
    """Write a text file in UTF-8 with plain line ends."""
    with replacing(path) as temporary:
        temporary.write_bytes(text.encode("utf-8"))
