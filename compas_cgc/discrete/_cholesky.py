"""Cholesky factorisation of small dense systems, compiled."""

from __future__ import annotations

import math

from .._compiled import kernel
from .arrays import FloatArray

MIN_PIVOT = 1e-14  # smallest pivot relative to the trace; 45 rounding errors


@kernel(inner=True)
def solve_in_place(M: FloatArray, r: FloatArray, n: int, lift: float) -> None:
    """Solve M x = r for the first n unknowns in place of r; only the lower half of M is read, and it is overwritten.

    The diagonal is raised by `lift` times the trace, so that a rank-deficient system has the smallest solution.
    """
    trace = 0.0
    for k in range(n):
        trace += M[k, k]
    for k in range(n):
        pivot = M[k, k] + lift * trace
        for m in range(k):
            pivot -= M[k, m] * M[k, m]
        least = MIN_PIVOT * trace
        M[k, k] = math.sqrt(pivot if pivot > least else least)
        for j in range(k + 1, n):
            for m in range(k):
                M[j, k] -= M[j, m] * M[k, m]
            M[j, k] /= M[k, k]
    for k in range(n):
        for m in range(k):
            r[k] -= M[k, m] * r[m]
        r[k] /= M[k, k]
    for k in range(n - 1, -1, -1):
        for m in range(k + 1, n):
            r[k] -= M[m, k] * r[m]
        r[k] /= M[k, k]
