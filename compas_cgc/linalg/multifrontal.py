"""Factors of symmetric matrices, positive definite or not, by the multifrontal method."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse

from ..discrete._memo import remembered
from ..discrete.arrays import CSRIndices
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from . import _fronts
from .errors import SingularMatrixError
from .ordering import MATRIX_BYTES
from .ordering import elimination_order
from .ordering import has_pattern
from .refinement import POOR
from .refinement import refined
from .superlu import SuperLU

__all__ = ["Multifrontal"]


class Multifrontal:
    r"""Factors :math:`L D L^T` with pivots from the diagonal, whose signs are those of the eigenvalues by Sylvester's law of inertia.

    Unknowns whose columns of L have the same rows are eliminated together in a small dense matrix, a front. What depends on the sparsity
    only is found once. The sums are always taken in the same order, on one core.

    Parameters
    ----------
    points
        ``(n, d)`` places of the unknowns, for the order of elimination.
    refine
        Whether solutions are checked and refined; where pivots on the diagonal are not good enough, others are chosen.

    References
    ----------
    Liu, *The multifrontal method for sparse matrix solution*, doi:10.1137/1034004. Davis, *Direct Methods for Sparse Linear Systems*,
    doi:10.1137/1.9780898718881.
    """

    def __init__(self, points: Optional[FloatArray] = None, refine: bool = True):
        self._points, self._refine = points, refine
        self._pattern: Optional[tuple[CSRIndices, CSRIndices]] = None
        self.negative = 0  # eigenvalues

    def factorise(self, matrix: sparse.csr_matrix) -> Multifrontal:
        """Factorise a symmetric matrix; the order of elimination is reused if the sparsity is that of the last one.

        Raises
        ------
        SingularMatrixError
            If a pivot vanishes.
        """
        matrix = sparse.csr_matrix(matrix)
        matrix.sort_indices()
        self._matrix = matrix
        if not has_pattern(matrix, self._pattern):
            self._pattern = matrix.indptr, matrix.indices
            self._order, self._tree = _analysed(matrix.indptr, matrix.indices, elimination_order(matrix, self._points))
            own, n = self._tree, matrix.shape[0]
            self._L, self._D, self._waiting = np.empty(own.offsets[-1]), np.empty(n), np.empty(own.most_waiting)
            self._room = np.empty((own.widest + 2 * _fronts.BLOCK) * own.widest)
        own = self._tree
        self.negative = _fronts.factors(
            matrix.data, own.source, own.place, own.ends, own.starts, own.bounds, own.places, own.above, own.offsets,
            self._L, self._D, self._waiting, self._room,
        )  # fmt: skip
        if self.negative < 0:
            raise SingularMatrixError("the matrix is singular: a pivot vanishes")
        return self

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Return the solutions (n,) or (n, k) for right-hand sides of that shape."""
        rhs = np.asarray(rhs, dtype=np.float64)
        if not self._refine:
            return self._applied(rhs)
        x, quality = refined(self._matrix, self._applied, rhs)
        return x if quality <= POOR else SuperLU(self._points).factorise(self._matrix).solve(rhs)

    def _applied(self, right: FloatArray) -> FloatArray:
        own, solution = self._tree, np.empty_like(right)
        x = np.ascontiguousarray(right[self._order] if right.ndim > 1 else right[self._order, None])
        _fronts.substitute(x, own.starts, own.bounds, own.rows, own.offsets, self._L, self._D, self._room)
        solution[self._order] = x.reshape(right.shape)
        return solution


class _Tree(NamedTuple):
    """Fronts in the order of elimination, children before parents."""

    starts: Indices  # (f + 1,) first pivots
    bounds: Indices  # (f + 1,) of their rows below
    rows: Indices
    places: Indices  # of these rows in the front above
    above: Indices  # (f,) fronts, -1 for none
    source: Indices  # entries of the matrix
    place: Indices  # of these entries in the front
    ends: Indices  # (f + 1,) of those of every front
    offsets: Indices  # (f + 1,) of their parts of L
    widest: int  # most pivots and rows of a front
    most_waiting: int  # most entries that wait for fronts above


def _analyse(indptr: CSRIndices, indices: CSRIndices, order: Indices) -> tuple[Indices, _Tree]:
    """Return the order (n,) of elimination with subtrees in one piece, and the fronts of a matrix."""
    n = len(order)
    numbered = sparse.csr_matrix((np.arange(1, len(indices) + 1), indices, indptr), shape=(n, n))
    # Sums of sparse matrices leave out zeros: an entry may be stored on one side of the diagonal alone.
    numbered = numbered.maximum(numbered.T.tocsr())
    lower = _upper(numbered, order).T.tocsr()
    order = order[_fronts.postorder(_fronts.elimination_tree(lower.indptr, lower.indices))]
    upper = _upper(numbered, order)
    lower = upper.T.tocsr()
    parent = _fronts.elimination_tree(lower.indptr, lower.indices)
    count = _fronts.column_counts(lower.indptr, lower.indices, parent)
    # Neighbours in the order whose columns of L have the same rows share a front.
    of = np.cumsum(np.append(True, (parent[:-1] != np.arange(1, n)) | (count[:-1] != count[1:] + 1))[:n]) - 1
    starts = np.append(np.flatnonzero(np.diff(of, prepend=-1)), n)
    last = starts[1:] - 1
    above = np.where(parent[last] >= 0, of[parent[last]], -1)
    below = count[last] - 1
    bounds = np.append(0, np.cumsum(below))
    rows = _fronts.rows_below(lower.indptr, lower.indices, of, above, bounds)
    widths = np.diff(starts) + below
    return order, _Tree(
        starts,
        bounds,
        rows,
        _fronts.places_in_parents(starts, bounds, rows, above),
        above,
        upper.data - 1,
        _fronts.places_of_entries(upper.indptr, upper.indices, starts, bounds, rows),
        upper.indptr[starts],
        np.append(0, np.cumsum(np.diff(starts) * widths)),
        int(widths.max(initial=0)),
        _most_waiting(above, below),
    )


_analysed = remembered(_analyse, largest=MATRIX_BYTES)


def _upper(matrix: sparse.csr_matrix, order: Indices) -> sparse.csr_matrix:
    """Return the upper triangle of a matrix in another order."""
    upper = sparse.triu(matrix[order][:, order], format="csr")
    upper.sort_indices()
    return upper


def _most_waiting(above: Indices, below: Indices) -> int:
    """Return how many entries wait for the fronts above at most."""
    now, most, unfinished = 0, 0, [-1]
    parents, sizes = above.tolist(), (below**2).tolist()
    for front, size in enumerate(sizes):
        while unfinished[-1] >= 0 and parents[unfinished[-1]] == front:
            now -= sizes[unfinished.pop()]
        if size:
            now += size
            most = max(most, now)
            unfinished.append(front)
    return most
