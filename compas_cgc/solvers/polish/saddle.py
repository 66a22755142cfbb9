"""Symmetric saddle matrices: the number of their negative eigenvalues, and refined solutions."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from ...discrete.arrays import FloatArray
from ...linalg.multifrontal import Multifrontal
from ...linalg.refinement import refined
from ...linalg.work import rights
from ...linalg.work import spend

__all__ = ["Saddle"]

FACTORS = 10.0  # right sides that factors take as long as
PRECISE, REFINEMENTS = 1e-12, 3  # relative residual of solutions, and rounds of refinement towards it


class Saddle:
    """Factors of matrices of one sparsity.

    Parameters
    ----------
    points
        ``(s, d)`` places of the unknowns.
    border
        ``(s, k)`` with k small: products with solutions are zero. They are dense, and are eliminated after the factors are known.
    """

    def __init__(self, points: FloatArray, border: FloatArray):
        self._factors, self._border = Multifrontal(points, refine=False), border

    def factorise(self, matrix: sparse.csr_matrix) -> int:
        """Take a matrix in, and return the number of its negative eigenvalues among vectors whose products with the border are zero.

        Raises
        ------
        SingularMatrixError
            If a pivot vanishes.
        """
        self._matrix = matrix
        spend(rights(FACTORS, matrix.shape[0]))
        negative, conditions = self._factors.factorise(matrix).negative, self._border.shape[1]
        if not conditions:
            return negative
        self._responses = self._refined(self._border)
        self._met = self._border.T @ self._responses
        return negative + int((np.linalg.eigvalsh(self._met + self._met.T) > 0.0).sum()) - conditions

    def roughly(self, right: FloatArray) -> FloatArray:
        """Return the solution for a right side (s,) without refinement."""
        return self._bordered(self._factors.solve(right))

    def solve(self, right: FloatArray) -> FloatArray:
        """Return the solution for a right side (s,)."""
        return self._bordered(self._refined(right))

    def _refined(self, right: FloatArray) -> FloatArray:
        return refined(self._matrix, self._factors.solve, right, PRECISE, REFINEMENTS)[0]

    def _bordered(self, solution: FloatArray) -> FloatArray:
        if not self._border.shape[1]:
            return solution
        return np.asarray(solution - self._responses @ np.linalg.solve(self._met, self._border.T @ solution))
