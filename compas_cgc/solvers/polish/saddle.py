"""Symmetric saddle matrices: the number of their negative eigenvalues, and refined solutions."""

from __future__ import annotations

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
    """

    def __init__(self, points: FloatArray):
        self._factors = Multifrontal(points, refine=False)

    def factorise(self, matrix: sparse.csr_matrix) -> int:
        """Take a matrix in, and return the number of its negative eigenvalues.

        Raises
        ------
        SingularMatrixError
            If a pivot vanishes.
        """
        self._matrix = matrix
        spend(rights(FACTORS, matrix.shape[0]))
        return self._factors.factorise(matrix).negative

    def roughly(self, right: FloatArray) -> FloatArray:
        """Return the solution for a right side (s,) without refinement."""
        return self._factors.solve(right)

    def solve(self, right: FloatArray) -> FloatArray:
        """Return the solution for a right side (s,)."""
        return refined(self._matrix, self._factors.solve, right, PRECISE, REFINEMENTS)[0]
