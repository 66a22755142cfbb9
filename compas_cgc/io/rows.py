"""Rows and numbers of a text file, with the row of every fault."""

from __future__ import annotations

import re
from collections.abc import Iterator

from .cursor import Cursor

__all__ = ["Rows", "number_of"]

_FORTRAN = re.compile(r"^([+-]?(?:\d+\.?\d*|\.\d+))[dD]([+-]?\d+)$")
_DECIMAL_COMMA = re.compile(r"^[+-]?\d+,\d+(?:[eE][+-]?\d+)?$")


def number_of(word: str) -> float:
    """Return the number in a word; exponents may be written with D, as Fortran does.

    Raises
    ------
    ValueError
        If it is none.
    """
    try:
        return float(word)
    except ValueError:
        fortran = _FORTRAN.match(word)
        if fortran:
            return float(f"{fortran[1]}e{fortran[2]}")
        if _DECIMAL_COMMA.match(word):
            raise ValueError(f"{word!r} has a decimal comma; export the file with decimal points") from None
        raise ValueError(f"{word[:40]!r} is not a number") from None


class Rows:
    """The rows of a text that are neither empty nor comments, read by rows or number by number.

    Parameters
    ----------
    cursor
        Position in the file; announced counts are checked with it.
    comments
        First words of rows that are passed over, besides ``#``.
    """

    def __init__(self, cursor: Cursor, comments: tuple[str, ...] = ()):
        self._cursor = cursor
        before = len(cursor.data[: cursor.position].splitlines())
        rows = ((before + number, text.split()) for number, text in cursor.lines())
        self._rows = [(number, words) for number, words in rows if words[0] not in comments]
        self._row = 0
        self._word = 0

    @property
    def left(self) -> int:
        """Number of rows that follow, without the rest of the current one."""
        return len(self._rows) - self._row - (1 if self._word else 0)

    @property
    def where(self) -> str:
        """The row that was read last, as the end of a file's name in a sentence."""
        at = min(self._row, len(self._rows)) - (0 if self._word else 1)
        return f", row {self._rows[max(0, at)][0]}" if self._rows else ""

    @property
    def in_row(self) -> bool:
        """Whether a part of the current row has been read."""
        return self._word > 0

    @property
    def row_size(self) -> int:
        """Number of words in the next row."""
        return len(self._rows[self._row][1]) if self._row < len(self._rows) else 0

    def peek(self) -> str:
        """Return the next word without moving on, an empty one at the end."""
        return self._rows[self._row][1][self._word] if self._row < len(self._rows) else ""

    def replace_first(self, word: str) -> None:
        """Put another word in the place of the next one, none if it is empty."""
        self._rows[self._row][1][self._word : self._word + 1] = [word] if word else []
        self._end_row()

    def row(self) -> list[str]:
        """Return the words of the next whole row."""
        if self._word:
            raise ValueError(f"{len(self._rows[self._row][1]) - self._word} numbers are left over in this row")
        if self._row >= len(self._rows):
            raise ValueError("the file ends too early")
        self._row += 1
        return self._rows[self._row - 1][1]

    def word(self) -> str:
        """Return the next word, wherever the row breaks."""
        if self._row >= len(self._rows):
            raise ValueError("the file ends too early")
        found = self.peek()
        self._word += 1
        self._end_row()
        return found

    def words(self) -> Iterator[str]:
        """Yield the words that follow, wherever the rows break."""
        while True:
            yield self.word()

    def integer(self) -> int:
        """Return the next word as a whole number."""
        return int(self.word())

    def real(self) -> float:
        """Return the next word as a number."""
        return number_of(self.word())

    def count(self, what: str) -> int:
        """Return the next word as a number of things that follow."""
        return self._cursor.count(self.integer(), 1, what)

    def refuse_rest(self) -> None:
        """Refuse numbers after all that the file declares.

        Raises
        ------
        ValueError
            With how many there are.
        """
        rest = sum(len(words) for _, words in self._rows[self._row :]) - self._word
        if rest > 0:
            raise ValueError(f"the file contains {rest} numbers more than its header declares")

    def _end_row(self) -> None:
        if self._word >= len(self._rows[self._row][1]):
            self._row, self._word = self._row + 1, 0
