"""Arithmetic of functions of three variables with their first and second derivatives, for compiled kernels.

A function is a row of ten numbers: its value, its derivatives by x, y, z, and those by xx, xy, xz, yy, yz, zz.
"""

from __future__ import annotations

from .._compiled import kernel
from .arrays import FloatArray

__all__ = ["ROW", "add_product", "compose", "multiply"]

ROW = 10


@kernel(inner=True)
def multiply(W: FloatArray, a: int, b: int, out: int) -> None:
    """Write the product of rows `a` and `b` into row `out`, which is neither of them."""
    for k in range(ROW):
        W[out, k] = 0.0
    add_product(W, 1.0, a, b, out)


@kernel(inner=True)
def add_product(W: FloatArray, factor: float, a: int, b: int, out: int) -> None:
    """Add a multiple of the product of rows `a` and `b` to row `out`, which is neither of them."""
    p, q = factor * W[a, 0], factor * W[b, 0]
    W[out, 0] += p * W[b, 0]
    at = 4
    for i in range(1, 4):
        W[out, i] += p * W[b, i] + q * W[a, i]
        for j in range(i, 4):
            W[out, at] += p * W[b, at] + q * W[a, at] + factor * (W[a, i] * W[b, j] + W[a, j] * W[b, i])
            at += 1


@kernel(inner=True)
def compose(W: FloatArray, value: float, first: float, second: float, a: int, out: int) -> None:
    """Write a function of row `a`, given by its value and two derivatives there, into row `out`."""
    at = 4
    for i in range(1, 4):
        for j in range(i, 4):
            W[out, at] = first * W[a, at] + second * W[a, i] * W[a, j]
            at += 1
    for i in range(1, 4):
        W[out, i] = first * W[a, i]
    W[out, 0] = value
