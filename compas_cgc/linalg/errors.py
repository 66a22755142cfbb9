"""The error of singular matrices."""

from __future__ import annotations

__all__ = ["SingularMatrixError"]


class SingularMatrixError(ArithmeticError):
    """The matrix is singular, or singular to rounding."""
