"""Rows and numbers of a text file, with the row of every fault."""

from __future__ import annotations

import re
from bisect import bisect_left
from bisect import bisect_right

from .cursor import Cursor

__all__ = ["Rows", "check_corners", "integer_of", "number_of"]

_FORTRAN = re.compile(r"^([+-]?(?:\d+\.?\d*|\.\d+))[dD]([+-]?\d+)$")
_INTEGER = re.compile(r"^[+-]?[0-9]{1,400}$")
_DECIMAL_COMMA = re.compile(r"^[+-]?\d+,\d+(?:[eE][+-]?\d+)?$")


def number_of(word: str) -> float:
    """Return the number in a word; exponents may be written with D, as Fortran does.

    Raises
    ------
    ValueError
        If the word is not a number.
    """
    try:
        if "_" not in word:  # Python would read 1_0 as 10
            return float(word)
    except ValueError:
        fortran = _FORTRAN.match(word)
        if fortran:
            return float(f"{fortran[1]}e{fortran[2]}")
        if _DECIMAL_COMMA.match(word):
            raise ValueError(f"{word!r} has a decimal comma; export the file with decimal points") from None
    raise ValueError(f"{word[:40]!r} is not a number")


def integer_of(word: str) -> int:
    """Return the integer in a word.

    Raises
    ------
    ValueError
        If the word is not an integer.
    """
    if not _INTEGER.match(word):
        raise ValueError(f"{word[:40]!r} is not an integer")
    return int(word)


def check_corners(count: int) -> int:
    """Return the declared number of corners of a face.

    Raises
    ------
    ValueError
        If it is less than three.
    """
    if count < 3:
        raise ValueError(f"a face needs at least 3 corners, not {count}")
    return count


class Rows:
    """The rows of a text that are neither empty nor comments, read by rows or number by number.

    Parameters
    ----------
    cursor
        Position in the file; declared counts are checked with it.
    comments
        First words of rows that are ignored, besides ``#``.
    """

    def __init__(self, cursor: Cursor, comments: tuple[str, ...] = ()):
        self._cursor = cursor
        before = len(cursor.data[: cursor.position].splitlines())
        self._words: list[str] = []
        self._starts: list[int] = []  # index of the first word of each row
        self._numbers: list[int] = []  # row of the file
        self.position = 0  # index of the next word
        for number, text in cursor.lines():
            words = text.split()
            if words[0] not in comments:
                self._starts.append(len(self._words))
                self._numbers.append(before + number)
                self._words += words

    @property
    def left(self) -> int:
        """Number of rows after the current one."""
        return len(self._starts) - bisect_left(self._starts, self.position)

    @property
    def where(self) -> str:
        """The row that was read last, as the end of a file's name in a sentence."""
        row = bisect_left(self._starts, self.position) - 1
        return f", row {self._numbers[max(0, row)]}" if self._numbers else ""

    @property
    def in_row(self) -> bool:
        """Whether a part of the current row has been read."""
        return self._end_of_row(self.position - 1) > self.position if self.position else False

    @property
    def row_size(self) -> int:
        """Number of words that follow in the row of the next word."""
        return self._end_of_row(self.position) - self.position

    def peek(self) -> str:
        """Return the next word without moving on, an empty one at the end."""
        return self._words[self.position] if self.position < len(self._words) else ""

    def replace_next(self, word: str) -> None:
        """Replace the next word, or remove it if the new one is empty."""
        self._words[self.position : self.position + 1] = [word] if word else []
        if not word:
            row = bisect_right(self._starts, self.position)
            self._starts[row:] = [start - 1 for start in self._starts[row:]]

    def row(self) -> list[str]:
        """Return the words of the next whole row."""
        if self.in_row:
            raise ValueError(f"{self.row_size} numbers are left over in this row")
        return self.words(max(1, self.row_size))

    def words(self, count: int) -> list[str]:
        """Return the next words, wherever the rows break."""
        found = self._words[self.position : self.position + count]
        self.position += len(found)
        if len(found) < count:
            raise ValueError("the file ends too early")
        return found

    def integer(self) -> int:
        """Return the next word as an integer."""
        return integer_of(self.words(1)[0])

    def count(self, what: str) -> int:
        """Return the next word as a number of things that follow."""
        return self._cursor.count(self.integer(), 1, what)

    def refuse_rest(self) -> None:
        """Reject numbers after all that the file declares.

        Raises
        ------
        ValueError
            With their number.
        """
        rest = len(self._words) - self.position
        if rest > 0:
            raise ValueError(f"the file contains {rest} numbers more than its header declares")

    def _end_of_row(self, position: int) -> int:
        """Return the index after the last word of a row."""
        row = bisect_right(self._starts, position)
        return self._starts[row] if row < len(self._starts) else len(self._words)
