"""Arithmetic of functions of three variables with their first and second derivatives, for compiled kernels.

A function is a row of ten numbers: its value, its derivatives by x, y, z, and those by xx, xy, xz, yy, yz, zz. All operations take
a tuple as long as the part of it that is computed, four or ten numbers, for which they are compiled apart.
"""

from __future__ import annotations

from .._compiled import kernel
from .arrays import FloatArray

__all__ = ["FIRST", "ROW", "Orders", "add_product", "compose", "multiply"]

Orders = tuple[bool, ...]
FIRST, ROW = 4, 10  # numbers of a row, up to first and up to second derivatives


@kernel(inner=True)
def multiply(W: FloatArray, orders: Orders, a: int, b: int, out: int) -> None:
    """Write the product of rows `a` and `b` into row `out`, which is neither of them."""
    for k in range(len(orders)):
        W[out, k] = 0.0
    add_product(W, orders, 1.0, a, b, out)


@kernel(inner=True)
def add_product(W: FloatArray, orders: Orders, factor: float, a: int, b: int, out: int) -> None:
    """Add a multiple of the product of rows `a` and `b` to row `out`, which is neither of them."""
    p, q = factor * W[a, 0], factor * W[b, 0]
    W[out, 0] += p * W[b, 0]
    for i in range(1, FIRST):
        W[out, i] += p * W[b, i] + q * W[a, i]
    if len(orders) > FIRST:
        at = FIRST
        for i in range(1, FIRST):
            for j in range(i, FIRST):
                W[out, at] += p * W[b, at] + q * W[a, at] + factor * (W[a, i] * W[b, j] + W[a, j] * W[b, i])
                at += 1


@kernel(inner=True)
def compose(W: FloatArray, orders: Orders, value: float, first: float, second: float, a: int, out: int) -> None:
    """Write a function of row `a`, given by its value and two derivatives there, into row `out`."""
    if len(orders) > FIRST:
        at = FIRST
        for i in range(1, FIRST):
            for j in range(i, FIRST):
                W[out, at] = first * W[a, at] + second * W[a, i] * W[a, j]
                at += 1
    for i in range(1, FIRST):
        W[out, i] = first * W[a, i]
    W[out, 0] = value
