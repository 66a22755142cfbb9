"""Factors of the metric and of the preconditioner."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Protocol

from scipy import sparse
from scipy.sparse.linalg import splu

from ..discrete.arrays import FloatArray
from ..linalg import SingularMatrixError

__all__ = ["Factor", "SingularMatrixError", "factorise"]

PARDISO_FROM = 50_000  # unknowns; below, SuperLU's solves are the faster ones


class Factor(Protocol):
    """A factorised matrix."""

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Return the solution ``(n,)`` or ``(n, k)`` for a right side of that shape."""


def factorise(matrix: sparse.csr_matrix) -> Factor:
    """Return the factors of a symmetric positive definite matrix; raises :class:`SingularMatrixError` where there are none.

    Without the refinement of :func:`compas_cgc.linalg.factorise`: the solves are the greater
    part of the work here, and any fixed matrix near to the inverse serves as a metric.
    """
    if matrix.shape[0] >= PARDISO_FROM and find_spec("pypardiso"):
        from ..linalg import factorise as factorise_by
        from ..linalg.pardiso import works

        if works():
            return factorise_by(matrix, symmetric=True, backend="pardiso")
    try:
        return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise SingularMatrixError(str(error)) from None
