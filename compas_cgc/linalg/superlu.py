"""SuperLU of SciPy, with an elimination order for meshes."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import Optional

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from ..discrete._memo import remembered
from ..discrete.arrays import CSRIndices
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from .errors import SingularMatrixError
from .ordering import elimination_order
from .ordering import has_pattern
from .refinement import POOR
from .refinement import refined

if TYPE_CHECKING:
    from scipy.sparse.linalg import SuperLU as Factors

__all__ = ["SuperLU"]

PANEL = 4  # columns per panel; a tenth faster than SuperLU's default


class SuperLU:
    """LU factors with pivots on the diagonal, and iterative refinement of the solutions.

    The order of elimination is found once per sparsity.

    Parameters
    ----------
    points
        ``(n, d)`` positions of the unknowns, if known.
    refine
        Whether solutions are checked and refined.
    """

    def __init__(self, points: Optional[FloatArray] = None, refine: bool = True):
        self._points = points
        self._refine = refine
        self._pattern: Optional[tuple[CSRIndices, CSRIndices]] = None
        self._lu: Optional[Factors] = None
        self._pivoted = False

    def factorise(self, matrix: sparse.csr_matrix) -> SuperLU:
        """Factorise a matrix; the elimination order is reused if the sparsity is that of the last one."""
        matrix = sparse.csr_matrix(matrix)
        matrix.sort_indices()
        self._lu = None  # frees the memory before the new factors are computed
        self._matrix = matrix
        if not has_pattern(matrix, self._pattern):
            self._order(matrix)
        try:
            self._factorise(matrix)
        except RuntimeError as error:
            raise SingularMatrixError(str(error)) from None
        return self

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Return the solution for a right-hand side."""
        rhs = np.asarray(rhs, dtype=np.float64)
        if not self._refine:
            return self._apply(rhs)
        x, quality = refined(self._matrix, self._apply, rhs)
        if not quality <= POOR and not self._pivoted:
            try:
                self._lu, self._pivoted = splu(self._matrix.tocsc()), True
            except RuntimeError as error:
                raise SingularMatrixError(str(error)) from None
            x, quality = refined(self._matrix, self._apply, rhs)
        if not np.isfinite(x).all():
            raise SingularMatrixError("the matrix is singular: the solution is not finite")
        return x

    def _order(self, matrix: sparse.csr_matrix) -> None:
        """Find the elimination order and the permuted position of each entry."""
        self._pattern = matrix.indptr, matrix.indices
        self._permutation = elimination_order(matrix, self._points)
        self._places = np.argsort(self._permutation)
        self._gather, self._indices, self._indptr = _permuted(matrix.indptr, matrix.indices, self._permutation)

    def _factorise(self, matrix: sparse.csr_matrix) -> None:
        # SuperLU expects columns: the rows are passed as such, so the transpose is factorised.
        transposed = sparse.csc_matrix((matrix.data[self._gather], self._indices, self._indptr), shape=matrix.shape)
        self._pivoted = False
        self._lu = splu(transposed, permc_spec="NATURAL", diag_pivot_thresh=0.0, panel_size=PANEL, options={"SymmetricMode": True})

    def _apply(self, rhs: FloatArray) -> FloatArray:
        if self._lu is None:
            raise SingularMatrixError("there are no factors; call factorise() first")
        if self._pivoted:
            return self._lu.solve(rhs)
        y = self._lu.solve(rhs.take(self._permutation, axis=0), "T")
        return y.T.take(self._places, axis=-1).T


@remembered
def _permuted(indptr: CSRIndices, indices: CSRIndices, order: Indices) -> tuple[CSRIndices, CSRIndices, CSRIndices]:
    """Return the positions of the entries, the indices and the row pointers of a matrix permuted to an elimination order."""
    n = len(indptr) - 1
    numbered = sparse.csr_matrix((np.arange(len(indices)), indices, indptr), shape=(n, n))
    permuted = numbered[order][:, order]
    permuted.sort_indices()
    return permuted.data, permuted.indices, permuted.indptr
