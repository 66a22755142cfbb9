"""Factors of the metric and of the preconditioner."""

from __future__ import annotations

from scipy import sparse

from .. import linalg

__all__ = ["factorise"]


def factorise(matrix: sparse.csr_matrix) -> linalg.LinearSolver:
    """Return the factors of a symmetric positive definite matrix; see :func:`compas_cgc.linalg.factorise`.

    Without refinement: the solves are the greater part of the work here, and any fixed matrix
    near to the inverse serves as a metric.
    """
    return linalg.factorise(matrix, symmetric=True, refine=False)
