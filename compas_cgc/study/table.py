"""Table of a study: a CSV file that grows in the order of the variants, and an array of their surfaces."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from typing import Optional

import numpy as np

from .._atomic_write import replacing
from ..errors import CGCError
from ..errors import FileError
from ..fabrication.tables import escaped
from ..fabrication.tables import unescaped
from .variants import Measured
from .writer import set_aside

__all__ = ["Table", "cells", "parsed", "read_rows", "write_parquet"]


class Table:
    """Writer of rows and surfaces; after a crash at any time, the files hold complete rows with their surfaces.

    Parameters
    ----------
    path, surfaces
        The CSV file, and the ``.npy`` file of ``(variants, n, 3)`` float64 [L], NaN for variants without a surface.
    columns
        Names of the columns.
    starts
        First values of the row of every variant: its number and parameters.
    vertices
        Number of vertices per variant, None if surfaces are not kept.

    Attributes
    ----------
    rows
        Number of written rows.
    """

    def __init__(self, path: Path, surfaces: Path, columns: Sequence[str], starts: Sequence[Sequence[Any]], vertices: Optional[int]):
        self.rows = _whole_rows(path, columns, starts)
        self._surfaces: Optional[np.memmap] = None
        try:
            if vertices is not None:
                self._surfaces = self._opened(path, surfaces, (len(starts), vertices, 3))
            self._file = open(path, "a", encoding="utf-8", newline="")
            if not self.rows and not self._file.tell():
                self._write([tuple(columns)])
        except (OSError, ValueError) as error:
            raise FileError(f"{path.parent} is not writable ({error}); free disk space or choose another folder") from None

    def _opened(self, path: Path, surfaces: Path, shape: tuple[int, int, int]) -> np.memmap:
        """Return the array of surfaces; a table without its surfaces is set aside."""
        known = self.rows > 0 and _is_array(surfaces, shape)
        if self.rows and not known:
            set_aside(surfaces)
            set_aside(path)
            self.rows = 0
        if not known:
            _reserve(surfaces, shape)
        return np.lib.format.open_memmap(surfaces, "r+")

    def add(self, block: Sequence[Measured]) -> None:
        """Write the next variants, surfaces first, so that every row has its surface.

        Raises
        ------
        FileError
            If the disk is full.
        """
        try:
            for one in block:
                if self._surfaces is not None:
                    self._surfaces[self.rows] = np.nan if one.vertices is None else one.vertices
                self.rows += 1
            self._write([one.row for one in block])
        except OSError as error:
            raise FileError(f"the table cannot be written ({error.strerror}); free disk space and start the study again") from None

    def close(self) -> None:
        """Close the files."""
        if self._surfaces is not None:
            self._surfaces.flush()
        self._file.close()

    def _write(self, rows: Sequence[tuple]) -> None:
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows(map(cells, rows))
        # Write all rows at once, so that no row is partial.
        self._file.write(text.getvalue())
        self._file.flush()


def cells(row: Sequence[Any]) -> list[str]:
    """Return the texts of the cells of a row."""
    return [str(escaped(_text(value))) for value in row]


def _text(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return repr(value)
    return " ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)


def _is_array(path: Path, shape: tuple[int, int, int]) -> bool:
    """Check whether a file is an array of a shape, with all of its numbers."""
    try:
        return np.load(path, mmap_mode="r", allow_pickle=False).shape == shape
    except (OSError, ValueError, EOFError):
        return False


def _reserve(path: Path, shape: tuple[int, int, int]) -> None:
    """Make an array on the disk, with the room for all of its numbers: a full disk would end the process that writes them."""
    np.lib.format.open_memmap(path, "w+", float, shape)
    if hasattr(os, "posix_fallocate"):
        with open(path, "r+b") as file:
            os.posix_fallocate(file.fileno(), 0, os.fstat(file.fileno()).st_size)


def _whole_rows(path: Path, columns: Sequence[str], starts: Sequence[Sequence[Any]]) -> int:
    """Return how many rows at the beginning of a table are whole and in order, and cut off what follows them.

    A table with rows of another study is set aside.
    """
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        return 0
    try:
        rows = list(csv.reader(io.StringIO(content[: content.rfind(b"\n") + 1].decode("utf-8", "replace"), newline="")))
    except csv.Error:
        rows = []
    if not rows or [unescaped(name) for name in rows[0]] != list(columns):
        # The folder is that of the study: the head is damaged.
        set_aside(path)
        return 0
    good = rows[:1]
    for start, row in zip(map(cells, starts), rows[1:]):
        if len(row) != len(columns) or row[0] != start[0]:
            break
        if row[: len(start)] != start:
            set_aside(path)
            return 0
        good.append(row)
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(good)
    whole = text.getvalue().encode("utf-8")
    if content != whole:
        if not content.startswith(whole):
            set_aside(path)
            return 0
        os.truncate(path, len(whole))
    return max(0, len(good) - 1)


def read_rows(path: Path) -> tuple[list[str], list[list[Any]]]:
    """Return the columns and rows of a table, with numbers converted and None for empty cells.

    Raises
    ------
    FileError
        If the table cannot be read or is empty.
    """
    try:
        with open(path, encoding="utf-8", newline="") as file:
            text = file.read()
    except OSError as error:
        raise FileError(f"{path} cannot be read ({error.strerror}); give the folder of a study") from None
    rows = list(csv.reader(io.StringIO(text[: text.rfind("\n") + 1])))
    if not rows:
        raise FileError(f"{path} is empty; the study has not started")
    return [unescaped(name) for name in rows[0]], [[parsed(word) for word in row] for row in rows[1:]]


def parsed(word: str) -> Any:
    """Return the number in a cell, None for an empty cell, else the text."""
    if not word:
        return None
    for kind in (int, float):
        try:
            return kind(word)
        except ValueError:
            continue
    return unescaped(word)


def write_parquet(path: Path, columns: Sequence[str], rows: Sequence[Sequence[Any]], needed: bool = False) -> Optional[Path]:
    """Write a table as Parquet if pyarrow is installed.

    Raises
    ------
    CGCError
        If `needed` is true and pyarrow is not installed.
    """
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        if needed:
            raise CGCError('Parquet requires pyarrow: pip install "compas_cgc[study]"; the table is also available as CSV') from None
        return None
    arrays = {name: pyarrow.array(_alike([row[k] for row in rows])) for k, name in enumerate(columns)}
    with replacing(path) as beside:
        parquet.write_table(pyarrow.table(arrays), beside)
    return path


def _alike(values: list[Any]) -> list[Any]:
    """Return values converted to one type, as required by Parquet."""
    kinds = {type(value) for value in values} - {type(None)}
    if kinds <= {int} or kinds <= {str}:
        return values
    one: Any = float if kinds <= {int, float} else str
    return [None if value is None else one(value) for value in values]
