"""Compiled least squares of polynomials over the tangent planes of vertices."""

from __future__ import annotations

import math

from .._compiled import kernel
from ._cholesky import solve_in_place
from .arrays import FloatArray
from .arrays import IntArray

__all__ = ["CENTRED", "least_squares"]

CENTRED = 0.2  # what a point's squared distance, against the farthest, is added to in its weight


@kernel()
def least_squares(
    places: FloatArray,
    count: IntArray,
    degree: int,
    weighted: FloatArray,
    factor: FloatArray,
    heights: FloatArray,
    lifted: FloatArray,
    squares: FloatArray,
    M: FloatArray,
    r: FloatArray,
    own: FloatArray,
) -> None:
    """Fit a polynomial to the `places` (3, k, c) around each of some vertices, and fill the arrays from `weighted` on as `Fit` has them.

    Of the points only the first `count` (k,) of a vertex count; where there is one unknown more than monomials, the
    last is the height of the polynomial over the vertex. `M` (t, t), `r` (t,) and `own` (t,) are room to work in.
    """
    terms = degree * (degree + 3) // 2
    unknowns = heights.shape[1]
    for i in range(places.shape[1]):
        for k in range(unknowns):
            r[k] = 0.0
            for m in range(unknowns):
                M[k, m] = 0.0
        if unknowns > terms:
            M[terms, terms] = 1.0 / CENTRED
        for c in range(places.shape[2]):
            u, v, w = places[0, i, c], places[1, i, c], places[2, i, c]
            # By the roots of their weights, so that their products are those of the least squares.
            root = 1.0 / math.sqrt(u * u + v * v + CENTRED) if c < count[i] else 0.0
            own[unknowns - 1] = root
            own[0], own[1] = u * root, v * root
            first = 0
            for d in range(2, degree + 1):
                for m in range(d):
                    own[first + d + m] = u * own[first + m]
                own[first + 2 * d] = v * own[first + d - 1]
                first += d
            for k in range(unknowns):
                weighted[i, k, c] = own[k]
                r[k] += own[k] * root * w
                for m in range(k + 1):
                    M[k, m] += own[k] * own[m]
        solve_in_place(M, r, unknowns, 0.0)
        for k in range(unknowns):
            heights[i, k] = r[k]
            for m in range(unknowns):
                factor[i, k, m] = M[k, m]
        squares[i, 0] = squares[i, 1] = 0.0
        over = r[terms] if unknowns > terms else 0.0
        for c in range(count[i]):
            whole = second = 0.0
            for k in range(terms):
                whole += r[k] * weighted[i, k, c]
                if 2 <= k < 5:
                    second += r[k] * weighted[i, k, c]
            u, v, w = places[0, i, c], places[1, i, c], places[2, i, c]
            root = math.sqrt(u * u + v * v + CENTRED)
            lifted[i, c] = whole * root
            off, bent = lifted[i, c] + over - w, second * root
            squares[i, 0] += off * off
            squares[i, 1] += bent * bent
