"""SuperLU, as in SciPy, ordered for meshes."""

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
from .sweeps import Sweeps

if TYPE_CHECKING:
    from scipy.sparse.linalg import SuperLU as Factors

__all__ = ["SuperLU"]

GOOD = 1e-10  # relative residual that needs no refinement
POOR = 1e-6  # relative residual from which the pivots on the diagonal are given up
REFINEMENTS = 2
PANEL = 4  # columns worked on together; a tenth faster than SuperLU's own choice
# Unknowns from which the factors are put in order: for fewer a first solve would compile for longer than ever is saved; and up to
# which so many solves are to be expected that it pays.
SWEPT = 500, 30_000


class SuperLU:
    """LU factors with pivots from the diagonal, and refinement to make up for that.

    The order of elimination is found once per sparsity.

    Parameters
    ----------
    symmetric
        The matrices are symmetric and positive definite.
    points
        ``(n, d)`` place of every unknown, if known.
    refine
        Whether solutions are checked and refined.
    """

    quick = False

    def __init__(self, symmetric: bool = False, points: Optional[FloatArray] = None, refine: bool = True):
        self._points = points
        self._symmetric = symmetric
        self._refine = refine
        self._pattern: Optional[tuple[CSRIndices, CSRIndices]] = None
        self._lu: Optional[Factors] = None
        self._sweeps: Optional[Sweeps] = None
        self._pivoted = False

    def factorise(self, matrix: sparse.csr_matrix) -> SuperLU:
        """Take a matrix in."""
        matrix = sparse.csr_matrix(matrix)
        matrix.sort_indices()
        self._lu = None  # free the old factors before the new ones are made
        self._matrix = matrix
        if not has_pattern(matrix, self._pattern):
            self._order(matrix)
        try:
            self._factorise(matrix)
        except RuntimeError as error:
            raise SingularMatrixError(str(error)) from None
        return self

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Return the solution for a right side."""
        rhs = np.asarray(rhs, dtype=np.float64)
        if not self._refine:
            return self._apply(rhs)
        x, quality = self._refined(rhs)
        if not quality <= POOR and not self._pivoted:
            try:
                self._lu, self._pivoted = splu(self._matrix.tocsc()), True
            except RuntimeError as error:
                raise SingularMatrixError(str(error)) from None
            x, quality = self._refined(rhs)
        if not np.isfinite(x).all():
            raise SingularMatrixError("the solution is not finite")
        return x

    def _order(self, matrix: sparse.csr_matrix) -> None:
        """Find the order, and where each entry of the matrix goes by it."""
        self._pattern = matrix.indptr, matrix.indices
        self._permutation = elimination_order(matrix, self._points)
        self._places = np.argsort(self._permutation)
        self._gather, self._indices, self._indptr = _permuted(matrix.indptr, matrix.indices, self._permutation)

    def _factorise(self, matrix: sparse.csr_matrix) -> None:
        # The rows of the matrix are handed over as columns: factors of the transposed.
        transposed = sparse.csc_matrix((matrix.data[self._gather], self._indices, self._indptr), shape=matrix.shape)
        self._pivoted = False
        self._lu = splu(transposed, permc_spec="NATURAL", diag_pivot_thresh=0.0, panel_size=PANEL, options={"SymmetricMode": True})
        swept = self._symmetric and not self._refine and SWEPT[0] <= matrix.shape[0] <= SWEPT[1]
        self._sweeps = _swept(self._lu) if swept else None

    def _apply(self, rhs: FloatArray) -> FloatArray:
        if self._lu is None:
            raise SingularMatrixError("there are no factors; factorise a matrix first")
        if self._pivoted:
            return self._lu.solve(rhs)
        if self._sweeps is not None:
            return self._sweeps.solve(rhs.take(self._permutation, axis=0)).take(self._places, axis=0)
        # Several right sides at once are solved faster by the factors than by their transposed.
        which = "N" if self._symmetric and rhs.ndim == 2 else "T"
        y = self._lu.solve(rhs.take(self._permutation, axis=0), which)
        return y.T.take(self._places, axis=-1).T

    def _refined(self, rhs: FloatArray) -> tuple[FloatArray, float]:
        """Return the solution and its relative residual."""
        scale = float(np.abs(rhs).max(initial=0.0)) or 1.0
        x = self._apply(rhs)
        residual = rhs - self._matrix @ x
        quality = float(np.abs(residual).max(initial=0.0)) / scale
        for _ in range(REFINEMENTS):
            if quality <= GOOD or not np.isfinite(quality):
                break
            better = x + self._apply(residual)
            residual = rhs - self._matrix @ better
            new = float(np.abs(residual).max(initial=0.0)) / scale
            if not new < 0.5 * quality:
                break
            x, quality = better, new
        return x, quality


def _swept(lu: Factors) -> Optional[Sweeps]:
    """Return the factors of a symmetric matrix put in order for many solves; None where pivots have left the diagonal."""
    own = np.arange(lu.shape[0])
    if not (np.array_equal(lu.perm_r, own) and np.array_equal(lu.perm_c, own)):
        return None
    try:
        return Sweeps(lu.L, lu.U.diagonal())
    except ValueError:
        # A factor may lack what comes out as zero by chance.
        return None


@remembered
def _permuted(indptr: CSRIndices, indices: CSRIndices, order: Indices) -> tuple[CSRIndices, CSRIndices, CSRIndices]:
    """Return the entries of a matrix in an order of elimination, and the pattern that they have in it."""
    n = len(indptr) - 1
    numbered = sparse.csr_matrix((np.arange(len(indices)), indices, indptr), shape=(n, n))
    permuted = numbered[order][:, order]
    permuted.sort_indices()
    return permuted.data, permuted.indices, permuted.indptr
