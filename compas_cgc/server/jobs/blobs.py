"""Blobs: requests and results as files, which take no memory while they wait and leave the disk when they are deleted."""

from __future__ import annotations

import hashlib
import os
import secrets
from collections.abc import Iterable
from collections.abc import Iterator
from contextlib import contextmanager
from contextlib import suppress
from pathlib import Path
from typing import IO
from typing import Optional

__all__ = ["Blobs", "blob_name", "pieces"]

PIECE = 2**20  # bytes
_OWN = secrets.token_hex(8)  # begins the names of files of this process that belong to no job yet


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

    @contextmanager
    def staged(self, content: Iterable[bytes]) -> Iterator[tuple[str, int]]:
        """Write the pieces of content to the disk, and delete it at the end of the block unless :meth:`place` gave it a place.

        Yields its name and its size [bytes].
        """
        name = f"{_OWN}-{secrets.token_hex(8)}"
        if self.folder is None:
            whole = self._memory[name] = b"".join(content)
            try:
                yield name, len(whole)
            finally:
                self._memory.pop(name, None)
            return
        path = self.folder / name
        try:
            with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as file:
                for piece in content:
                    file.write(piece)
                size = file.tell()
                file.flush()
                os.fsync(file.fileno())
            yield name, size
        finally:
            path.unlink(missing_ok=True)

    def place(self, name: str, kind: str, id: str) -> None:
        """Make staged content that of a kind and id, without waiting for the disk."""
        if self.folder is None:
            self._memory[blob_name(kind, id)] = self._memory.pop(name)
        else:
            os.replace(self.folder / name, self.folder / blob_name(kind, id))

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
            if entry.is_file() and entry.name not in names and not entry.name.startswith(_OWN):
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


def pieces(stream: IO[bytes]) -> Iterable[bytes]:
    """Yield the content of a stream in pieces."""
    return iter(lambda: stream.read(PIECE), b"")
