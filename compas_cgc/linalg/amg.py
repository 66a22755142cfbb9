"""Conjugate gradients preconditioned by algebraic multigrid, by the package pyamg."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from ..discrete.arrays import FloatArray
from .errors import SingularMatrixError

__all__ = ["AMG"]

TOLERANCE = 1e-11
CYCLES = 200


class AMG:
    """Smoothed aggregation for symmetric positive definite matrices; memory grows linearly with n."""

    def factorise(self, matrix: sparse.csr_matrix) -> AMG:
        """Set up the multigrid hierarchy of a matrix."""
        from pyamg import smoothed_aggregation_solver

        self._hierarchy = smoothed_aggregation_solver(sparse.csr_matrix(matrix))
        return self

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Return the solution for a right-hand side, to a relative residual of 1e-11."""
        rhs = np.asarray(rhs, dtype=np.float64)
        if rhs.ndim == 2:
            return np.column_stack([self.solve(column) for column in rhs.T])
        x, failed = self._hierarchy.solve(rhs, tol=TOLERANCE, maxiter=CYCLES, accel="cg", return_info=True)
        if failed or not np.isfinite(x).all():
            raise SingularMatrixError(f"multigrid did not converge in {CYCLES} cycles")
        return x
