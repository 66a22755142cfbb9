"""Substitutions with the factors of a symmetric matrix, four columns at a time: they read half as much memory as those of an LU."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from .._compiled import kernel
from ..discrete.arrays import CSRIndices
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray

__all__ = ["Sweeps"]

PANEL_WIDTH = 4  # columns of a panel; the loops are unrolled for this number
MAX_PADDING = 0.2  # part of the entries of a column that may be explicit zeros, so that it joins the panel of the next column


class Sweeps:
    """Forward and backward substitution for ``L D Lᵀ``.

    Neighbouring columns with entries in the same rows form a panel, as in a supernodal factorisation: every unknown
    below is read and written once per panel.

    Parameters
    ----------
    lower
        ``(n, n)`` L, with ones on its diagonal.
    diagonal
        ``(n,)`` the diagonal of D.

    Raises
    ------
    ValueError
        If L does not have the sparsity of a Cholesky factor: if the first entry of a column below the diagonal is in row i,
        its further entries have to be in rows where column i has entries too.

    References
    ----------
    Ng and Peyton, doi:10.1137/0914063.

    Examples
    --------
    >>> lower = sparse.csc_matrix([[1.0, 0.0], [0.5, 1.0]])
    >>> Sweeps(lower, np.array([2.0, 4.0])).solve(np.array([2.0, 5.0])).tolist()
    [0.5, 1.0]
    """

    def __init__(self, lower: sparse.csc_matrix, diagonal: FloatArray):
        n = len(diagonal)
        first = np.flatnonzero(_begins_panel(lower.indptr, lower.indices))
        last = np.append(first[1:], n) - 1
        columns = first[:, None] + np.arange(PANEL_WIDTH)
        self._columns = np.where(columns <= last[:, None], columns, n)
        self._start = np.concatenate([[0], np.cumsum(np.diff(lower.indptr)[last] - 1)])
        self._rows, self._entries = np.zeros(self._start[-1] + 1, np.uint32), np.zeros((self._start[-1], PANEL_WIDTH))
        self._corners = np.zeros((len(first), PANEL_WIDTH, PANEL_WIDTH))
        place, into = np.full(n, self._start[-1]), (self._start, self._rows, self._entries, self._corners)
        if not _fill(lower.indptr, lower.indices, lower.data, first, last, place, *into):
            raise ValueError("L does not have the sparsity of a Cholesky factor")
        self._inverse = np.append(1.0 / diagonal, 0.0)

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Return the solution ``(n,)`` or ``(n, k)`` for a right-hand side of that shape."""
        pairs = rhs.reshape(len(rhs), -1)
        solved = [self._pair(pairs[:, k : k + 2]) for k in range(0, pairs.shape[1], 2)]
        return (solved[0] if len(solved) == 1 else np.concatenate(solved, axis=1)).reshape(rhs.shape)

    def _pair(self, rhs: FloatArray) -> FloatArray:
        n, k = rhs.shape
        x = np.zeros((n + 1, 2))
        x[:n, :k] = rhs
        _substitute(self._columns, self._start, self._rows, self._entries, self._corners, self._inverse, x)
        return x[:n, :k]


@kernel()
def _begins_panel(indptr: CSRIndices, indices: CSRIndices) -> NDArray[np.bool_]:
    """Mark the columns that are the first of their panel (n,)."""
    n = len(indptr) - 1
    begins = np.ones(n, np.bool_)
    width = 1
    for j in range(1, n):
        before, size = indptr[j] - indptr[j - 1], indptr[j + 1] - indptr[j]
        joins = False
        if width < PANEL_WIDTH and size - (before - 1) <= MAX_PADDING * size:
            for at in range(indptr[j - 1], indptr[j]):
                joins = joins or indices[at] == j
        begins[j] = not joins
        width = width + 1 if joins else 1
    return begins


@kernel()
def _fill(
    indptr: CSRIndices,
    indices: CSRIndices,
    data: FloatArray,
    first: IntArray,
    last: IntArray,
    place: IntArray,
    start: IntArray,
    rows: NDArray[np.uint32],
    entries: FloatArray,
    corners: FloatArray,
) -> bool:
    """Write the rows and entries of the panels, and the entries between their columns; return False if an entry has no row in its panel."""
    for p in range(len(first)):
        to = start[p]
        for at in range(indptr[last[p]], indptr[last[p] + 1]):
            i = indices[at]
            if i > last[p]:
                rows[to], place[i] = i, to
                to += 1
        for j in range(first[p], last[p] + 1):
            for at in range(indptr[j], indptr[j + 1]):
                i = indices[at]
                if i > last[p]:
                    if place[i] < start[p] or rows[place[i]] != i:
                        return False
                    entries[place[i], j - first[p]] = data[at]
                elif i > j:
                    corners[p, i - first[p], j - first[p]] = data[at]
    return True


@kernel()
def _substitute(
    columns: IntArray,
    start: IntArray,
    rows: NDArray[np.uint32],
    entries: FloatArray,
    corners: FloatArray,
    inverse: FloatArray,
    x: FloatArray,
) -> None:
    """Solve for two right-hand sides (n + 1, 2) in place; columns missing in a panel are the last unknown, which stays zero."""
    for p in range(len(columns)):
        i, j, k, m = columns[p, 0], columns[p, 1], columns[p, 2], columns[p, 3]
        c = corners[p]
        a0, b0 = x[i, 0], x[i, 1]
        a1, b1 = x[j, 0] - c[1, 0] * a0, x[j, 1] - c[1, 0] * b0
        a2, b2 = x[k, 0] - c[2, 0] * a0 - c[2, 1] * a1, x[k, 1] - c[2, 0] * b0 - c[2, 1] * b1
        a3 = x[m, 0] - c[3, 0] * a0 - c[3, 1] * a1 - c[3, 2] * a2
        b3 = x[m, 1] - c[3, 0] * b0 - c[3, 1] * b1 - c[3, 2] * b2
        x[j, 0], x[k, 0], x[m, 0] = a1, a2, a3
        x[j, 1], x[k, 1], x[m, 1] = b1, b2, b3
        for at in range(start[p], start[p + 1]):
            row = rows[at]
            l0, l1, l2, l3 = entries[at, 0], entries[at, 1], entries[at, 2], entries[at, 3]
            x[row, 0] -= (l0 * a0 + l1 * a1) + (l2 * a2 + l3 * a3)
            x[row, 1] -= (l0 * b0 + l1 * b1) + (l2 * b2 + l3 * b3)
    for p in range(len(columns) - 1, -1, -1):
        i, j, k, m = columns[p, 0], columns[p, 1], columns[p, 2], columns[p, 3]
        c = corners[p]
        a0 = a1 = a2 = a3 = 0.0
        b0 = b1 = b2 = b3 = 0.0
        for at in range(start[p], start[p + 1]):
            row = rows[at]
            y, z = x[row, 0], x[row, 1]
            l0, l1, l2, l3 = entries[at, 0], entries[at, 1], entries[at, 2], entries[at, 3]
            a0 += l0 * y
            a1 += l1 * y
            a2 += l2 * y
            a3 += l3 * y
            b0 += l0 * z
            b1 += l1 * z
            b2 += l2 * z
            b3 += l3 * z
        a3, b3 = x[m, 0] * inverse[m] - a3, x[m, 1] * inverse[m] - b3
        a2, b2 = x[k, 0] * inverse[k] - a2 - c[3, 2] * a3, x[k, 1] * inverse[k] - b2 - c[3, 2] * b3
        a1 = x[j, 0] * inverse[j] - a1 - c[2, 1] * a2 - c[3, 1] * a3
        b1 = x[j, 1] * inverse[j] - b1 - c[2, 1] * b2 - c[3, 1] * b3
        x[i, 0] = x[i, 0] * inverse[i] - a0 - c[1, 0] * a1 - c[2, 0] * a2 - c[3, 0] * a3
        x[i, 1] = x[i, 1] * inverse[i] - b0 - c[1, 0] * b1 - c[2, 0] * b2 - c[3, 0] * b3
        x[j, 0], x[k, 0], x[m, 0] = a1, a2, a3
        x[j, 1], x[k, 1], x[m, 1] = b1, b2, b3
