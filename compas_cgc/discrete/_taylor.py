"""Expressions of functions of three variables with their first and second derivatives, evaluated for many elements at once.

A function is a row of ten numbers for every element of a block: its value, its derivatives by x, y, z, and those by xx, xy, xz, yy, yz, zz.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from .._compiled import kernel
from .arrays import FloatArray
from .arrays import IntArray

__all__ = ["BLOCK", "FIRST", "SECOND", "Expressions", "evaluate"]

FIRST = 4  # numbers of a row up to first derivatives; a value and three derivatives
SECOND = 10  # numbers of a row up to second derivatives; six more
BLOCK = 32  # elements that are evaluated together; their loops are vectorised, and all rows stay in the processor's cache
PRODUCT, PLUS, MINUS, TIMES, PLUS_TIMES, ROOT, INVERSE, ANGLE = range(8)
PAIRS = np.array([(x, y) for x in range(1, FIRST) for y in range(x, FIRST)])  # of the first derivatives in each second one


class Expressions:
    """Operations in the order in which they are evaluated; every one writes a row of its own, whose number it returns."""

    def __init__(self) -> None:
        self.rows = 0
        self._operations: list[tuple[int, int, int, int]] = []

    @property
    def operations(self) -> IntArray:
        """Kind, two operands and result of every operation (o, 4)."""
        return np.array(self._operations)

    def inputs(self, count: int) -> list[int]:
        """Return new rows that are written before the evaluation."""
        self.rows += count
        return list(range(self.rows - count, self.rows))

    def product(self, a: int, b: int) -> int:
        """Return a b."""
        return self._added(PRODUCT, a, b)

    def dot(self, a: Sequence[int], b: Sequence[int]) -> int:
        """Return the scalar product of two vectors."""
        row = self.product(a[0], b[0])
        for x in range(1, len(a)):
            self._operations.append((PLUS, a[x], b[x], row))
        return row

    def cross(self, a: Sequence[int], b: Sequence[int]) -> list[int]:
        """Return the vector product of two vectors."""
        rows = []
        for y, z in ((1, 2), (2, 0), (0, 1)):
            rows.append(self.product(a[y], b[z]))
            self._operations.append((MINUS, a[z], b[y], rows[-1]))
        return rows

    def component(self, constants: Sequence[int], a: Sequence[int]) -> int:
        """Return the scalar product of a vector of constants, of which only the values are read, and a vector."""
        row = self._added(TIMES, constants[0], a[0])
        for x in range(1, len(a)):
            self._operations.append((PLUS_TIMES, constants[x], a[x], row))
        return row

    def root(self, a: int) -> int:
        """Return the square root of a."""
        return self._added(ROOT, a, a)

    def inverse(self, a: int) -> int:
        """Return 1 / a."""
        return self._added(INVERSE, a, a)

    def angle(self, tangent: int, x: int) -> int:
        """Return the angle of the point (x, x tangent) in the plane."""
        return self._added(ANGLE, tangent, x)

    def _added(self, kind: int, a: int, b: int) -> int:
        row = self.inputs(1)[0]
        self._operations.append((kind, a, b, row))
        return row


@kernel(inner=True)
def evaluate(operations: IntArray, pairs: IntArray, orders: int, W: FloatArray) -> None:
    """Evaluate expressions for a block of elements, with 4 or 10 orders of derivatives.

    W (rows + 1, 10, BLOCK) has the inputs, takes all results, and has a row to work in at its end.
    """
    slope, bend = W[-1, 0], W[-1, 1]
    for k in range(len(operations)):
        kind, A, B, C = operations[k, 0], W[operations[k, 1]], W[operations[k, 2]], W[operations[k, 3]]
        if kind == TIMES or kind == PLUS_TIMES:
            for at in range(orders):
                for x in range(BLOCK):
                    value = A[0, x] * B[at, x]
                    C[at, x] = value if kind == TIMES else C[at, x] + value
        elif kind <= MINUS:
            if kind == PRODUCT:
                for at in range(orders):
                    for x in range(BLOCK):
                        C[at, x] = 0.0
            sign = -1.0 if kind == MINUS else 1.0
            for x in range(BLOCK):
                C[0, x] += sign * (A[0, x] * B[0, x])
            for at in range(1, orders):
                for x in range(BLOCK):
                    C[at, x] += sign * (A[0, x] * B[at, x] + A[at, x] * B[0, x])
            for at in range(FIRST, orders):
                i, j = pairs[at - FIRST]
                for x in range(BLOCK):
                    C[at, x] += sign * (A[i, x] * B[j, x] + A[j, x] * B[i, x])
        else:
            for x in range(BLOCK):
                v = A[0, x]
                if kind == ROOT:
                    C[0, x] = math.sqrt(v)
                    slope[x] = 0.5 / C[0, x]
                    bend[x] = -0.5 * slope[x] / v
                elif kind == INVERSE:
                    C[0, x] = 1.0 / v
                    slope[x] = -C[0, x] * C[0, x]
                    bend[x] = -2.0 * slope[x] * C[0, x]
                else:
                    C[0, x] = math.atan2(v * B[0, x], B[0, x])
                    slope[x] = 1.0 / (1.0 + v * v)
                    bend[x] = -2.0 * v * slope[x] * slope[x]
            for at in range(1, orders):
                for x in range(BLOCK):
                    C[at, x] = slope[x] * A[at, x]
            for at in range(FIRST, orders):
                i, j = pairs[at - FIRST]
                for x in range(BLOCK):
                    C[at, x] += bend[x] * A[i, x] * A[j, x]
