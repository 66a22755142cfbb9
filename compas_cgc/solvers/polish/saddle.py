"""Factors of symmetric saddle matrices, with the number of their negative pivots."""

from __future__ import annotations

from typing import Optional

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from ...discrete.arrays import FloatArray
from ...linalg import SingularMatrixError
from ...linalg.ordering import elimination_order
from ...linalg.work import rights
from ...linalg.work import spend

__all__ = ["Saddle"]

FACTORS = 25.0  # right sides that factors take as long as
PANEL = 4  # columns that SuperLU works on together
PRECISE, REFINEMENTS = 1e-12, 3  # relative residual of solutions, and rounds of refinement towards it
GAIN = 0.5  # of the residual before, above which a round brings nothing more


class Saddle:
    """Factors with pivots from the diagonal in an order that is found once: by Sylvester's law their signs are those of the eigenvalues.

    Parameters
    ----------
    points
        ``(s, d)`` places of the unknowns.
    """

    def __init__(self, points: FloatArray):
        self._points = points
        self._order: Optional[np.ndarray] = None

    def factorise(self, matrix: sparse.csr_matrix) -> int:
        """Take a matrix in, and return the number of its negative eigenvalues.

        Raises
        ------
        SingularMatrixError
            If a pivot vanishes.
        """
        if self._order is None:
            self._order = elimination_order(matrix, self._points)
            numbered = sparse.csr_matrix((np.arange(matrix.nnz), matrix.indices, matrix.indptr), shape=matrix.shape)
            permuted = numbered[self._order][:, self._order]
            permuted.sort_indices()
            self._gather, self._pattern = permuted.data, (permuted.indices, permuted.indptr)
        self._matrix = matrix
        spend(rights(FACTORS, matrix.shape[0]))
        own = sparse.csc_matrix((matrix.data[self._gather], *self._pattern), shape=matrix.shape)
        try:
            self._factors = splu(own, permc_spec="NATURAL", diag_pivot_thresh=0.0, panel_size=PANEL, options={"SymmetricMode": True})
        except RuntimeError as error:
            raise SingularMatrixError(str(error)) from None
        return int((self._factors.U.diagonal() < 0.0).sum())

    def solve(self, right: FloatArray) -> FloatArray:
        """Return the solution for a right side (s,)."""
        x, scale, before = self._applied(right), float(np.abs(right).max(initial=0.0)), np.inf
        for _ in range(REFINEMENTS):
            residual = right - self._matrix @ x
            left = float(np.abs(residual).max(initial=0.0))
            if not PRECISE * scale < left < GAIN * before:
                break
            x, before = x + self._applied(residual), left
        return x

    def _applied(self, right: FloatArray) -> FloatArray:
        x = np.empty_like(right)
        x[self._order] = self._factors.solve(right[self._order])
        return x
