"""Symmetric saddle matrices: the number of their negative eigenvalues, and refined solutions."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from ...discrete.arrays import FloatArray
from ...linalg.multifrontal import Multifrontal
from ...linalg.work import rights
from ...linalg.work import spend

__all__ = ["Saddle"]

FACTORS = 10.0  # right sides that factors take as long as
PRECISE, REFINEMENTS = 1e-12, 3  # relative residual of solutions, and rounds of refinement towards it
GAIN = 0.5  # of the residual before, above which a round brings nothing more


class Saddle:
    """Factors of matrices of one sparsity.

    Parameters
    ----------
    points
        ``(s, d)`` places of the unknowns.
    """

    def __init__(self, points: FloatArray):
        self._factors = Multifrontal(points)

    def factorise(self, matrix: sparse.csr_matrix) -> int:
        """Take a matrix in, and return the number of its negative eigenvalues.

        Raises
        ------
        SingularMatrixError
            If a pivot vanishes.
        """
        self._matrix = matrix
        spend(rights(FACTORS, matrix.shape[0]))
        return self._factors.factorise(matrix)

    def roughly(self, right: FloatArray) -> FloatArray:
        """Return the solution for a right side (s,) without refinement."""
        return self._factors.solve(right)

    def solve(self, right: FloatArray) -> FloatArray:
        """Return the solution for a right side (s,)."""
        x, scale, before = self._factors.solve(right), float(np.abs(right).max(initial=0.0)), np.inf
        for _ in range(REFINEMENTS):
            residual = right - self._matrix @ x
            left = float(np.abs(residual).max(initial=0.0))
            if not PRECISE * scale < left < GAIN * before:
                break
            x, before = x + self._factors.solve(residual), left
        return x
