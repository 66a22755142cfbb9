"""The error of singular matrices."""

from __future__ import annotations

__all__ = ["SingularMatrixError"]


class SingularMatrixError(ArithmeticError):
    """The matrix has no inverse, or none that rounding leaves anything of."""
