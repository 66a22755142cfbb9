"""Cursor: checked reading of untrusted files."""

from __future__ import annotations

import time
from codecs import BOM_UTF16_BE
from codecs import BOM_UTF16_LE
from collections.abc import Iterable
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from typing import NamedTuple
from typing import TypeVar

import numpy as np

from ..errors import CGCError
from ..errors import FileError
from ._files import read_bytes

__all__ = ["READ_LIMITS", "Cursor", "ReadLimits", "guarded", "reason_of"]

_STRIDE = 1024  # number of items between two checks of the time
Item = TypeVar("Item")


class ReadLimits(NamedTuple):
    """Limits of reading one file."""

    bytes: int = 2**30  # size of the file
    elements: int = 50_000_000  # number of values in the whole file
    nesting: int = 64  # levels of lists and objects
    seconds: float = 300.0


READ_LIMITS = ReadLimits()


class Cursor:
    """Read position in the bytes of a file, which moves forward only.

    A count declared in the file is checked against the number of remaining bytes before memory is allocated.

    Parameters
    ----------
    data
        Content of the file.
    limits
        Limits on bytes, elements, nesting and time.

    Raises
    ------
    ValueError
        By all methods, if the content exceeds a limit or ends too early.
    """

    def __init__(self, data: bytes, limits: ReadLimits = READ_LIMITS):
        if len(data) > limits.bytes:
            raise ValueError(f"it has more than {limits.bytes / 2**20:.0f} MB")
        self.data = data
        self.limits = limits
        self.position = 0
        self._elements = 0
        self._end = time.monotonic() + limits.seconds

    @classmethod
    def of_file(cls, path: Path, limits: ReadLimits = READ_LIMITS) -> Cursor:
        """Open a file.

        Raises
        ------
        FileError
            If the file cannot be read.
        """
        return cls(read_bytes(path, limits.bytes + 1), limits)

    @property
    def left(self) -> int:
        """Number of remaining bytes."""
        return len(self.data) - self.position

    def count(self, announced: int, size: int = 1, what: str = "elements") -> int:
        """Return a declared number of elements of at least `size` bytes each, after checking that the file can hold them."""
        if announced < 0:
            raise ValueError(f"the file declares {announced} {what}, but a number cannot be negative")
        if announced * max(1, size) > self.left:
            raise ValueError(f"the file declares {announced} {what}, but only {self.left} bytes follow")
        self._elements += announced
        if self._elements > self.limits.elements:
            raise ValueError(f"it holds more than {self.limits.elements} elements")
        return announced

    def skip(self, size: int) -> None:
        """Advance by a number of bytes."""
        self.position += self.count(size, 1, "bytes")

    def array(self, kind: Any, count: int) -> np.ndarray:
        """Return the next `count` values of a NumPy type."""
        kind = np.dtype(kind)
        values = np.frombuffer(self.data, kind, self.count(count, kind.itemsize, "values"), self.position)
        self.position += values.nbytes
        return values

    def words(self) -> Iterator[bytes]:
        """Yield the remaining words of a text."""
        return self.timed(self.data[self.position :].split())

    def lines(self, comment: str = "#") -> Iterator[tuple[int, str]]:
        """Yield number and text of every line that is neither empty nor a comment; a backslash at the end continues a line."""
        text = self.text()
        if "\0" in text:
            raise ValueError("it is not a text file, despite its suffix")
        joined: list[str] = []
        for number, line in enumerate(self.timed(text.splitlines()), 1):
            line = line.split(comment, 1)[0].strip()
            if line.endswith("\\"):
                joined.append(line[:-1])
                continue
            line = " ".join([*joined, line]).strip()
            joined.clear()
            if line:
                yield number, line

    def text(self) -> str:
        """Return the remaining text, decoded as UTF-16 if it begins with the mark of it, else as UTF-8 or Latin-1."""
        rest = self.data[self.position :]
        if rest[:2] in (BOM_UTF16_LE, BOM_UTF16_BE):
            return rest.decode("utf-16")
        try:
            return rest.decode("utf-8-sig")
        except UnicodeDecodeError:
            return rest.decode("latin-1")

    def timed(self, items: Iterable[Item]) -> Iterator[Item]:
        """Yield items until the time limit is exceeded."""
        for number, item in enumerate(items):
            if number % _STRIDE == 0 and time.monotonic() > self._end:
                raise ValueError(f"reading it takes more than {self.limits.seconds:g} s")
            yield item

    def check_nesting(self, value: object) -> None:
        """Check the nesting of parsed JSON."""
        level = [value]
        for _ in range(self.limits.nesting):
            level = [item for node in level for item in _inner(node)]
            if not level:
                return
        raise ValueError(f"it is nested more than {self.limits.nesting} levels deep")


@contextmanager
def guarded(path: Path) -> Iterator[None]:
    """Convert every error of a reader to a :class:`FileError`.

    Damaged content can make a reader fail anywhere; the original error is kept as the cause.
    """
    try:
        # Damaged coordinates may overflow; the checks of the readers refuse them.
        with np.errstate(over="ignore", invalid="ignore"):
            yield
    except (CGCError, OSError):
        raise
    except Exception as error:
        raise FileError(f"{path} cannot be read ({reason_of(error)}); export it again") from error


def reason_of(error: Exception) -> str:
    """Return the reason for an error in a reader, as a clause about the content."""
    if isinstance(error, RecursionError):
        return "it is nested too deeply"
    if isinstance(error, KeyError):
        return f"{error} is missing"
    return (str(error) or type(error).__name__)[:200]


def _inner(node: object) -> Iterable:
    items = node.values() if isinstance(node, dict) else node if isinstance(node, list) else ()
    return [item for item in items if isinstance(item, (dict, list))]
