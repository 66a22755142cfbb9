"""Compiled shape operators of triangles by the normals at the middles of their edges, with two derivatives."""

from __future__ import annotations

import math

from .._compiled import kernel
from ._taylor import ROW
from ._taylor import Orders
from ._taylor import add_product
from ._taylor import compose
from ._taylor import multiply
from .arrays import Faces
from .arrays import FloatArray
from .arrays import IntArray
from .arrays import Vectors
from .arrays import Vertices

__all__ = ["PARTS", "ROWS", "expand"]

# Rows of the working space: edges and their cross product, then what is computed from them.
EDGE, CROSS, SQUARE, ROOT, AREA, SIDE, LENGTH2, LENGTH, SCALE, UNIT, ALONG, ACROSS, TANGENT, TURN, TENSOR, SPARE = (
    0, 9, 12, 13, 14, 15, 18, 19, 20, 21, 24, 25, 26, 27, 30, 48,
)  # fmt: skip
ROWS, PARTS = 50, 22


@kernel(inner=True)
def _expand(V: Vertices, F: Faces, U: Vectors, R: Vectors, index: IntArray, f: int, W: FloatArray, orders: Orders) -> None:
    """Expand what a face contributes, as functions of the moves of its corners along their directions.

    Rows from TURN (3): angle of the reference direction of each edge, from the normal outwards. Rows from TENSOR (18): of each edge
    ``(e x c)(e x c)^T / (l |c|^2)`` with its vector e, its length l and the cross product c of two edges. Row AREA.
    """
    for k in range(ROWS):
        for x in range(ROW):
            W[k, x] = 0.0
    for k in range(3):
        p, q = F[f, (k + 1) % 3], F[f, (k + 2) % 3]
        for x in range(3):
            W[EDGE + 3 * k + x, 0] = V[q, x] - V[p, x]
            W[EDGE + 3 * k + x, 1 + (k + 1) % 3] = -U[p, x]
            W[EDGE + 3 * k + x, 1 + (k + 2) % 3] = U[q, x]
    for x in range(3):
        y, z = (x + 1) % 3, (x + 2) % 3
        add_product(W, orders, 1.0, EDGE + y, EDGE + 3 + z, CROSS + x)
        add_product(W, orders, -1.0, EDGE + z, EDGE + 3 + y, CROSS + x)
    for x in range(3):
        add_product(W, orders, 1.0, CROSS + x, CROSS + x, SQUARE)
    q = W[SQUARE, 0]
    root = math.sqrt(q)
    compose(W, orders, 0.5 * root, 0.25 / root, -0.125 / (q * root), SQUARE, AREA)
    compose(W, orders, 1.0 / root, -0.5 / (q * root), 0.75 / (q * q * root), SQUARE, ROOT)
    for k in range(3):
        edge, at = EDGE + 3 * k, index[f, k]
        for row in range(SIDE, TURN):
            for x in range(len(orders)):
                W[row, x] = 0.0
        for x in range(3):
            y, z = (x + 1) % 3, (x + 2) % 3
            add_product(W, orders, 1.0, edge + y, CROSS + z, SIDE + x)
            add_product(W, orders, -1.0, edge + z, CROSS + y, SIDE + x)
            add_product(W, orders, 1.0, edge + x, edge + x, LENGTH2)
        for x in range(len(orders)):
            for y in range(3):
                W[ALONG, x] += R[at, y] * W[SIDE + y, x]
                W[SPARE, x] = W[SPARE, x] + R[at, y] * W[CROSS + y, x] if y else R[at, y] * W[CROSS + y, x]
        l2 = W[LENGTH2, 0]
        l = math.sqrt(l2)
        compose(W, orders, l, 0.5 / l, -0.25 / (l * l2), LENGTH2, LENGTH)
        multiply(W, orders, LENGTH, SPARE, ACROSS)
        x0, y0 = W[ACROSS, 0], W[ALONG, 0]
        compose(W, orders, 1.0 / x0, -1.0 / (x0 * x0), 2.0 / (x0 * x0 * x0), ACROSS, SPARE)
        multiply(W, orders, ALONG, SPARE, TANGENT)
        slope = 1.0 / (1.0 + W[TANGENT, 0] * W[TANGENT, 0])
        compose(W, orders, math.atan2(y0, x0), slope, -2.0 * W[TANGENT, 0] * slope * slope, TANGENT, TURN + k)
        quarter = math.sqrt(l)
        compose(W, orders, 1.0 / quarter, -0.25 / (l2 * quarter), 0.3125 / (l2 * l2 * quarter), LENGTH2, SPARE)
        multiply(W, orders, SPARE, ROOT, SCALE)
        for x in range(3):
            multiply(W, orders, SIDE + x, SCALE, UNIT + x)
        entry = TENSOR + 6 * k
        for x in range(3):
            for y in range(x, 3):
                multiply(W, orders, UNIT + x, UNIT + y, entry)
                entry += 1


@kernel()
def expand(V: Vertices, F: Faces, U: Vectors, R: Vectors, index: IntArray, W: FloatArray, orders: Orders, out: FloatArray) -> None:
    """Write what every face contributes into `out` (m, 22, 4 or 10): three angles, three tensors of six entries, and its area."""
    for f in range(F.shape[0]):
        _expand(V, F, U, R, index, f, W, orders)
        for x in range(len(orders)):
            for k in range(PARTS - 1):
                out[f, k, x] = W[TURN + k, x]
            out[f, PARTS - 1, x] = W[AREA, x]
