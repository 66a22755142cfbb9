"""Sparsity pattern of matrices that couple neighbouring vertices."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from ._memo import remembered
from .arrays import CSRIndices
from .arrays import Faces
from .arrays import FloatArray
from .arrays import Indices

__all__ = ["RingPattern"]


class RingPattern:
    """Sparsity of matrices with a row per chosen vertex, filled at its ring of neighbours.

    Built once per mesh; matrices on it share ``indptr`` and ``indices``.

    Parameters
    ----------
    faces
        ``(m, 3)`` vertex indices.
    n
        Number of vertices.
    rows
        ``(k,)`` distinct vertices that have a row, in the order of the rows.
    columns
        ``(c,)`` distinct vertices that have a column, in the order of the columns.
    """

    def __init__(self, faces: Faces, n: int, rows: ArrayLike, columns: ArrayLike):
        self.faces: Faces = np.ascontiguousarray(faces, dtype=np.int64)
        self.rows: Indices = np.ascontiguousarray(rows, dtype=np.int64)
        self.columns: Indices = np.ascontiguousarray(columns, dtype=np.int64)
        self.indptr: CSRIndices
        self.indices: CSRIndices
        # Where the derivative of corner a's equation by corner b's move is kept (m, 3, 3), -1 for nowhere.
        self.slots: CSRIndices
        self.indptr, self.indices, self.slots = _entries(self.faces, n, self.rows, self.columns)

    @property
    def size(self) -> int:
        """Number of entries."""
        return len(self.indices)

    def matrix(self, data: FloatArray) -> sparse.csr_matrix:
        """Return the matrix (k, c) with the entries `data` (size,)."""
        return _csr(data, self.indices, self.indptr, (len(self.rows), len(self.columns)))

    def block_matrix(self, data: FloatArray) -> sparse.csr_matrix:
        """Return the matrix (k, 3c) with the entries `data` (size, 3), three columns per vertex."""
        indptr, indices = self._blocks
        return _csr(data.ravel(), indices, indptr, (len(self.rows), 3 * len(self.columns)))

    @cached_property
    def _blocks(self) -> tuple[CSRIndices, CSRIndices]:
        """The rows and columns with three of these per vertex."""
        indices = (3 * self.indices[:, None] + np.arange(3, dtype=self.indices.dtype)).ravel()
        return 3 * self.indptr, indices


@remembered
def _entries(faces: Faces, n: int, rows: Indices, columns: Indices) -> tuple[CSRIndices, CSRIndices, CSRIndices]:
    """Return the CSR pattern, and the place in it of what each corner adds (m, 3, 3)."""
    row_of, column_of = (_places(chosen, n) for chosen in (rows, columns))
    row, column = np.broadcast_arrays(row_of[faces][:, :, None], column_of[faces][:, None, :])
    used = (row >= 0) & (column >= 0)
    indptr, indices = _pattern(row[used], column[used], (len(rows), len(columns)))
    slots: CSRIndices = np.full(row.shape, -1, np.int32)
    slots[used] = _slots(row[used], column[used], indptr, indices, len(columns))
    return indptr, indices, slots


def _places(chosen: Indices, n: int) -> Indices:
    """Return the place of every vertex in `chosen`, -1 where it is not there (n,)."""
    place = np.full(n, -1, np.int64)
    place[chosen] = np.arange(len(chosen))
    return place


def _pattern(row: Indices, column: Indices, shape: tuple[int, int]) -> tuple[CSRIndices, CSRIndices]:
    """Return the CSR pattern of entries that may come several times."""
    entries = sparse.csr_matrix((np.ones(len(row), np.int8), (row, column)), shape=shape)
    entries.sum_duplicates()
    return entries.indptr.astype(np.int32, copy=False), entries.indices.astype(np.int32, copy=False)


def _slots(row: Indices, column: Indices, indptr: CSRIndices, indices: CSRIndices, width: int) -> Indices:
    """Return the places of entries in a CSR pattern."""
    keys = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr)) * width + indices
    return np.searchsorted(keys, row * width + column)


def _csr(data: FloatArray, indices: CSRIndices, indptr: CSRIndices, shape: tuple[int, int]) -> sparse.csr_matrix:
    matrix = sparse.csr_matrix((data, indices, indptr), shape=shape, copy=False)
    matrix.has_sorted_indices = True
    matrix.has_canonical_format = True
    return matrix
