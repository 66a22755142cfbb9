"""Blobs: requests and results as files, which take no memory while they wait and leave the disk when they are deleted."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Optional

from ..._atomic_write import replacing

__all__ = ["Blobs", "blob_name"]


class Blobs:
    """Content by kind and id.

    Parameters
    ----------
    folder
        Where the files are, None to hold all in memory.
    """

    def __init__(self, folder: Optional[Path]):
        self.folder = folder
        self._memory: dict[str, bytes] = {}
        if folder is not None:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)

    def put(self, kind: str, id: str, content: bytes) -> None:
        """Write content, which is on the disk when this returns."""
        if self.folder is None:
            self._memory[blob_name(kind, id)] = content
            return
        with replacing(self.folder / blob_name(kind, id)) as temporary:
            temporary.write_bytes(content)

    def get(self, kind: str, id: str) -> Optional[bytes]:
        """Return content, None if it is not there."""
        if self.folder is None:
            return self._memory.get(blob_name(kind, id))
        try:
            return (self.folder / blob_name(kind, id)).read_bytes()
        except FileNotFoundError:
            return None

    def delete(self, kind: str, id: str) -> None:
        """Delete content, if it is there."""
        self._memory.pop(blob_name(kind, id), None)
        if self.folder is not None:
            with suppress(OSError):
                (self.folder / blob_name(kind, id)).unlink()

    def keep_only(self, known: Iterable[tuple[str, str]]) -> None:
        """Delete all content but that of these kinds and ids, as a server that was killed may leave some."""
        if self.folder is None:
            return
        names = {blob_name(kind, id) for kind, id in known}
        for entry in os.scandir(self.folder):
            if entry.is_file() and entry.name not in names:
                with suppress(OSError):
                    os.unlink(entry.path)

    def bytes(self) -> int:
        """Return the size of all content."""
        if self.folder is None:
            return sum(map(len, self._memory.values()))
        total = 0
        for entry in os.scandir(self.folder):
            with suppress(OSError):
                total += entry.stat().st_size
        return total


def blob_name(kind: str, id: str) -> str:
    """Return the name of the file of content."""
    return f"{hashlib.sha256(id.encode()).hexdigest()[:40]}.{kind}"
