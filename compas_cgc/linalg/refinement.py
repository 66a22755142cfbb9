"""Iterative refinement of solutions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import sparse

from ..discrete.arrays import FloatArray

__all__ = ["POOR", "refined"]

GOOD = 1e-10  # relative residual below which a solution is not refined
POOR = 1e-6  # relative residual above which pivots on the diagonal are not good enough
REFINEMENTS = 2
GAIN = 0.5  # of the residual before, above which a round brings nothing more


def refined(
    matrix: sparse.csr_matrix,
    solve: Callable[[FloatArray], FloatArray],
    right: FloatArray,
    good: float = GOOD,
    rounds: int = REFINEMENTS,
) -> tuple[FloatArray, float]:
    """Return the solution (n,) or (n, k) that factors give for right sides of that shape, and its relative residual.

    Parameters
    ----------
    matrix
        ``(n, n)``.
    solve
        With its factors.
    right
        Right sides.
    good
        Relative residual that is good enough.
    rounds
        Refinements at most.
    """
    scale = float(np.abs(right).max(initial=0.0)) or 1.0
    x = solve(right)
    residual = right - matrix @ x
    quality = float(np.abs(residual).max(initial=0.0)) / scale
    for _ in range(rounds):
        if quality <= good or not np.isfinite(quality):
            break
        better = x + solve(residual)
        residual = right - matrix @ better
        new = float(np.abs(residual).max(initial=0.0)) / scale
        if not new < GAIN * quality:
            break
        x, quality = better, new
    return x, quality
