"""Symmetric saddle matrices: the number of their negative eigenvalues, and refined solutions."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from ...discrete.arrays import TINY
from ...discrete.arrays import FloatArray
from ...linalg.multifrontal import Multifrontal
from ...linalg.refinement import refined
from ...linalg.work import rights
from ...linalg.work import spend
from ...model.tolerances import ROUNDING

__all__ = ["Saddle"]

FACTORS = 10.0  # work of a factorisation [right sides]; estimate of the time, which affects the work limit only
REFINEMENTS = 3  # rounds of iterative refinement [rounds]; each gains several digits unless the matrix is singular


class Saddle:
    """Factors of matrices of one sparsity, and conditions on the solutions.

    Parameters
    ----------
    points
        ``(s, d)`` places of the unknowns.
    """

    def __init__(self, points: FloatArray):
        self._factors = Multifrontal(points, refine=False)

    def factorise(self, matrix: sparse.csr_matrix, border: FloatArray) -> int:
        """Take a matrix in, and return the number of its negative eigenvalues among vectors whose products with a border are zero.

        Raises
        ------
        SingularMatrixError
            If a pivot vanishes.
        """
        self._matrix = matrix
        spend(rights(FACTORS, matrix.shape[0]))
        negative = self._factors.factorise(matrix).negative
        self.hold(border)
        return negative - int((self._values < 0.0).sum())

    def hold(self, border: FloatArray) -> None:
        """Prescribe the products of solutions with a dense border (s, k), k small; it is eliminated after the factors are known.

        Columns may depend on each other.
        """
        self._scales = 1.0 / np.maximum(np.linalg.norm(border, axis=0), TINY)
        self._border = border * self._scales
        self._responses = self._refined(self._border) if border.shape[1] else border
        met = self._border.T @ self._responses
        values, vectors = np.linalg.eigh(0.5 * (met + met.T))
        used = np.abs(values) > ROUNDING * np.abs(values).max(initial=0.0)
        self._values, self._vectors = values[used], vectors[:, used]

    @property
    def conditions(self) -> int:
        """Number of products that are prescribed."""
        return len(self._scales)

    def roughly(self, right: FloatArray, products: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the same as :meth:`solve` without refinement."""
        return self._bordered(self._factors.solve(right), products)

    def solve(self, right: FloatArray, products: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the solution for a right side (s,) with products (k,) with the border, and the multipliers of these (k,)."""
        return self._bordered(self._refined(right), products)

    def _refined(self, right: FloatArray) -> FloatArray:
        return refined(self._matrix, self._factors.solve, right, ROUNDING, REFINEMENTS)[0]

    def _bordered(self, solution: FloatArray, products: FloatArray) -> tuple[FloatArray, FloatArray]:
        if not len(products):
            return solution, products
        excess = self._vectors.T @ (self._border.T @ solution - self._scales * products)
        forces = self._vectors @ (excess / self._values)
        return np.asarray(solution - self._responses @ forces), self._scales * forces
