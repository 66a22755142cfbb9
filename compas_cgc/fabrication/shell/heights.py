"""Heights of a region over a plane as a tensor-product spline, and the curvature of their graph."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray

__all__ = ["DEGREE", "SECOND_ORDERS", "Curvature", "HeightSpace", "curvature", "located", "nonzero_functions", "tensor_products"]

DEGREE = 4  # K depends on second derivatives, which are then smooth
MIN_SPANS = 2
SECOND_ORDERS = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))  # the derivatives on which K depends


class HeightSpace(NamedTuple):
    """Splines over a rectangle of the plane."""

    knots: tuple[FloatArray, FloatArray]  # with multiple ends [L]

    @classmethod
    def over(cls, low: FloatArray, high: FloatArray, cell: float) -> HeightSpace:
        """Return the space over a rectangle with spans of at most `cell` [L]."""
        knots = []
        for start, end in zip(low.tolist(), high.tolist()):
            t = np.linspace(start, end, max(MIN_SPANS, int(np.ceil((end - start) / cell))) + 1)
            knots.append(np.concatenate([np.full(DEGREE, start), t, np.full(DEGREE, end)]))
        return cls((knots[0], knots[1]))

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of coefficients in both directions."""
        u, v = (len(own) - DEGREE - 1 for own in self.knots)
        return u, v

    @property
    def size(self) -> int:
        """Number of coefficients."""
        return self.shape[0] * self.shape[1]

    def basis(self, xy: FloatArray, order: tuple[int, int] = (0, 0)) -> sparse.csr_matrix:
        """Return the values, or derivatives of an order, of the basis functions at points (k, 2): (k, size)."""
        places = [located(own, xy[:, axis]) for axis, own in enumerate(self.knots)]
        one, other = (nonzero_functions(own, *at, derivative) for own, at, derivative in zip(self.knots, places, order))
        first = (places[0][1] - DEGREE) * self.shape[1] + places[1][1] - DEGREE
        return tensor_products(one, other, first, np.full(len(xy), self.shape[1]), self.size)

    def roughness(self) -> sparse.csr_matrix:
        """Return rows (k, size) whose squares sum to the mean squared third derivative of the heights."""
        lines = []
        for own in self.knots:
            inner = own[DEGREE:-DEGREE]
            lines.append((inner[:-1, None] + np.diff(inner)[:, None] * [0.25, 0.75]).ravel())
        grid = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)
        orders = (((3, 0), 1.0), ((2, 1), 3.0), ((1, 2), 3.0), ((0, 3), 1.0))
        return sparse.vstack([self.basis(grid, order) * np.sqrt(times / len(grid)) for order, times in orders]).tocsr()


def located(knots: FloatArray, x: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return coordinates (k,) inside of the knots, and the indices (k,) of the knots before them."""
    count = len(knots) - DEGREE - 1
    inside = np.clip(x, knots[DEGREE], knots[count])
    return inside, np.clip(np.searchsorted(knots, inside, side="right") - 1, DEGREE, count - 1)


def nonzero_functions(knots: FloatArray, x: FloatArray, spans: IntArray, order: int) -> FloatArray:
    """Return the nonzero basis functions (k, DEGREE + 1) at `located` coordinates, or derivatives, by the recursion of Cox and de Boor."""
    values, x, spans = np.ones((len(x), 1)), x[:, None], spans[:, None]
    for degree in range(1, DEGREE + 1):
        low, high = (knots[spans + np.arange(first, first + degree)] for first in (1 - degree, 1))
        share = values / (high - low)
        if degree > DEGREE - order:
            rising, falling = degree * share, -degree * share
        else:
            rising, falling = (x - low) * share, (high - x) * share
        values = np.zeros((len(x), degree + 1))
        values[:, 1:] = rising
        values[:, :-1] += falling
    return values


def tensor_products(one: FloatArray, other: FloatArray, first: IntArray, widths: IntArray, size: int) -> sparse.csr_matrix:
    """Return products of functions of both directions (k, DEGREE + 1) as rows (k, size), from their first columns and row widths (k,)."""
    window = np.arange(DEGREE + 1)
    columns = first[:, None, None] + widths[:, None, None] * window[:, None] + window
    rows = np.arange(len(first) + 1) * (DEGREE + 1) ** 2
    return sparse.csr_matrix(((one[:, :, None] * other[:, None, :]).ravel(), columns.ravel(), rows), shape=(len(first), size))


class Curvature(NamedTuple):
    """K of a graph at points, with its derivatives with respect to the five derivatives of the heights."""

    K: FloatArray  # (k,)
    gradients: tuple[FloatArray, ...]  # (k,) each, in the order of SECOND_ORDERS


def curvature(p: FloatArray, q: FloatArray, r: FloatArray, s: FloatArray, t: FloatArray) -> Curvature:
    """Return the curvature of the graph of heights with first derivatives p, q and second ones r, s, t (k,)."""
    w = 1.0 + p * p + q * q
    K = (r * t - s * s) / w**2
    return Curvature(K, (-4.0 * K * p / w, -4.0 * K * q / w, t / w**2, -2.0 * s / w**2, r / w**2))
