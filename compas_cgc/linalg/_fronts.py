"""Compiled parts of the multifrontal method: elimination tree, fronts, factors and substitutions."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._compiled import kernel
from ..discrete.arrays import CSRIndices
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices

__all__ = [
    "column_counts",
    "elimination_tree",
    "factors",
    "places_in_parents",
    "places_of_entries",
    "postorder",
    "rows_below",
    "substitute",
]

BLOCK = 32  # pivots of a front whose rows are taken from the others at once


@kernel()
def elimination_tree(indptr: CSRIndices, indices: CSRIndices) -> Indices:
    """Return the parents (n,) of the unknowns of a symmetric matrix: the first in whose row an unknown fills in, -1 for none."""
    n = len(indptr) - 1
    parent, ancestor = np.full(n, -1), np.full(n, -1)
    for i in range(n):
        for at in range(indptr[i], indptr[i + 1]):
            j = indices[at]
            while j != -1 and j < i:
                above = ancestor[j]
                ancestor[j] = i
                if above == -1:
                    parent[j] = i
                j = above
    return parent


@kernel()
def postorder(parent: Indices) -> Indices:
    """Return the unknowns (n,) of a tree, children before parents, every subtree in one piece."""
    n = len(parent)
    first, sibling = np.full(n + 1, -1), np.full(n, -1)
    for i in range(n - 1, -1, -1):
        above = parent[i] if parent[i] >= 0 else n
        sibling[i], first[above] = first[above], i
    order, path = np.empty(n, np.int64), np.empty(n + 1, np.int64)
    path[0], deep, done = n, 1, 0
    while deep > 0:
        i = path[deep - 1]
        child = first[i]
        if child >= 0:
            first[i] = sibling[child]
            path[deep] = child
            deep += 1
        else:
            deep -= 1
            if i < n:
                order[done] = i
                done += 1
    return order


@kernel()
def column_counts(indptr: CSRIndices, indices: CSRIndices, parent: Indices) -> Indices:
    """Return the number of entries (n,) of every column of the factor, with the diagonal."""
    n = len(parent)
    count, reached = np.full(n, 1), np.full(n, -1)
    for i in range(n):
        reached[i] = i
        for at in range(indptr[i], indptr[i + 1]):
            j = indices[at]
            while j < i and reached[j] != i:
                reached[j] = i
                count[j] += 1
                j = parent[j]
    return count


@kernel()
def rows_below(indptr: CSRIndices, indices: CSRIndices, of: Indices, above: Indices, bounds: Indices) -> Indices:
    """Return the rows that every front has besides its pivots, ascending, between its bounds (f + 1,)."""
    rows, filled, reached = np.empty(bounds[-1], np.int64), bounds.copy(), np.full(len(above), -1)
    for i in range(len(indptr) - 1):
        for at in range(indptr[i], indptr[i + 1]):
            if indices[at] < i:
                front = of[indices[at]]
                while front != of[i] and reached[front] != i:
                    reached[front] = i
                    rows[filled[front]] = i
                    filled[front] += 1
                    front = above[front]
    return rows


@kernel()
def places_in_parents(starts: Indices, bounds: Indices, rows: Indices, above: Indices) -> Indices:
    """Return the place of every row below a front in the front above it."""
    places = np.empty(len(rows), np.int64)
    for front in range(len(above)):
        parent = above[front]
        pivots, at = starts[parent + 1] - starts[parent], bounds[parent]
        for k in range(bounds[front], bounds[front + 1]):
            if rows[k] < starts[parent + 1]:
                places[k] = rows[k] - starts[parent]
            else:
                while rows[at] < rows[k]:
                    at += 1
                places[k] = pivots + at - bounds[parent]
    return places


@kernel()
def places_of_entries(indptr: CSRIndices, indices: CSRIndices, starts: Indices, bounds: Indices, rows: Indices) -> Indices:
    """Return the places of the entries of an upper triangle in the fronts of their rows."""
    places, local = np.empty(len(indices), np.int64), np.empty(len(indptr) - 1, np.int64)
    for front in range(len(starts) - 1):
        first, pivots = starts[front], starts[front + 1] - starts[front]
        width = pivots + bounds[front + 1] - bounds[front]
        for j in range(pivots):
            local[first + j] = j
        for k in range(bounds[front], bounds[front + 1]):
            local[rows[k]] = pivots + k - bounds[front]
        for j in range(pivots):
            for at in range(indptr[first + j], indptr[first + j + 1]):
                places[at] = j * width + local[indices[at]]
    return places


@kernel()
def factors(
    data: FloatArray,
    source: Indices,
    place: Indices,
    ends: Indices,
    starts: Indices,
    bounds: Indices,
    places: Indices,
    above: Indices,
    offsets: Indices,
    L: FloatArray,
    D: FloatArray,
    waiting: FloatArray,
    room: FloatArray,
) -> Any:
    """Write L and D of L D L^T, and return the number of negative pivots, -1 where one vanishes or is no number.

    Fronts are matrices of their pivots and the rows below, of which the upper triangle is used. `waiting` has room for what fronts leave
    to those above them, `room` for two blocks of pivots and the largest front.
    """
    negative, top, left = 0, 0, 0
    begin, unfinished = np.empty(len(above), np.int64), np.empty(len(above), np.int64)
    for front in range(len(above)):
        pivots, below = starts[front + 1] - starts[front], bounds[front + 1] - bounds[front]
        width = pivots + below
        size = width * width
        flat = room[2 * BLOCK * width : 2 * BLOCK * width + size]
        flat[:] = 0.0
        for k in range(ends[front], ends[front + 1]):
            flat[place[k]] += data[source[k]]
        while left > 0 and above[unfinished[left - 1]] == front:
            left -= 1
            child = unfinished[left]
            top, first = begin[child], bounds[child]
            count = bounds[child + 1] - first
            for i in range(count):
                to, of = places[first + i] * width, top + i * count
                for j in range(i, count):
                    flat[to + places[first + j]] += waiting[of + j]
        F = flat.reshape((width, width))
        for done in range(0, pivots, BLOCK):
            now = min(pivots, done + BLOCK)
            for j in range(done, now):
                pivot = F[j, j]
                if pivot == 0.0 or not np.isfinite(pivot):
                    return -1
                if pivot < 0.0:
                    negative += 1
                for i in range(j + 1, now):
                    _subtract(F[i, i:], F[j, i] / pivot, F[j, i:])
            _eliminate(F, done, now, room)
        at = offsets[front]
        for j in range(pivots):
            pivot = F[j, j]
            D[starts[front] + j] = pivot
            row, to = F[j, j + 1 :], L[at + j * width + j + 1 : at + (j + 1) * width]
            for k in range(len(row)):
                to[k] = row[k] / pivot
        if below > 0:
            begin[front], unfinished[left] = top, front
            left += 1
            for i in range(below):
                row, to = F[pivots + i, pivots + i :], waiting[top + i : top + below]
                for k in range(len(row)):
                    to[k] = row[k]
                top += below
    return negative


@kernel(inner=True)
def _eliminate(F: FloatArray, done: int, now: int, room: FloatArray) -> None:
    """Take the rows of pivots from all rows after them, four of each at a time, so that numbers stay in registers."""
    left, count = len(F) - now, now - done
    W = room[: count * left].reshape((count, left))
    X = room[count * left : 2 * count * left].reshape((count, left))
    for j in range(count):
        row, to, scaled, pivot = F[done + j, now:], W[j], X[j], F[done + j, done + j]
        for k in range(left):
            to[k], scaled[k] = row[k], row[k] / pivot
    fours, by_fours = left - left % 4, count - count % 4
    for i in range(0, fours, 4):
        F0, F1, F2, F3 = F[now + i, now + i :], F[now + i + 1, now + i :], F[now + i + 2, now + i :], F[now + i + 3, now + i :]
        for j in range(0, by_fours, 4):
            a0, a1, a2, a3 = X[j, i], X[j + 1, i], X[j + 2, i], X[j + 3, i]
            b0, b1, b2, b3 = X[j, i + 1], X[j + 1, i + 1], X[j + 2, i + 1], X[j + 3, i + 1]
            c0, c1, c2, c3 = X[j, i + 2], X[j + 1, i + 2], X[j + 2, i + 2], X[j + 3, i + 2]
            d0, d1, d2, d3 = X[j, i + 3], X[j + 1, i + 3], X[j + 2, i + 3], X[j + 3, i + 3]
            W0, W1, W2, W3 = W[j, i:], W[j + 1, i:], W[j + 2, i:], W[j + 3, i:]
            for k in range(left - i):
                w0, w1, w2, w3 = W0[k], W1[k], W2[k], W3[k]
                F0[k] -= (a0 * w0 + a1 * w1) + (a2 * w2 + a3 * w3)
                F1[k] -= (b0 * w0 + b1 * w1) + (b2 * w2 + b3 * w3)
                F2[k] -= (c0 * w0 + c1 * w1) + (c2 * w2 + c3 * w3)
                F3[k] -= (d0 * w0 + d1 * w1) + (d2 * w2 + d3 * w3)
        for j in range(by_fours, count):
            for r in range(4):
                _subtract(F[now + i + r, now + i :], X[j, i + r], W[j, i:])
    for i in range(fours, left):
        for j in range(count):
            _subtract(F[now + i, now + i :], X[j, i], W[j, i:])


@kernel(inner=True)
def _subtract(row: FloatArray, factor: float, other: FloatArray) -> None:
    """Take a multiple of another row from a row; counted from zero such loops are vectorised."""
    for k in range(len(row)):
        row[k] -= factor * other[k]


@kernel()
def substitute(
    x: FloatArray, starts: Indices, bounds: Indices, rows: Indices, offsets: Indices, L: FloatArray, D: FloatArray, own: FloatArray
) -> None:
    """Turn right sides (n, k) into solutions; `own` has room for the rows of a front."""
    for column in range(x.shape[1]):
        for front in range(len(starts) - 1):
            first, pivots, below = starts[front], starts[front + 1] - starts[front], bounds[front]
            width = pivots + bounds[front + 1] - below
            for j in range(width):
                own[j] = x[first + j, column] if j < pivots else 0.0
            for j in range(pivots):
                at, value = offsets[front] + j * width, own[j]
                _subtract(own[j + 1 : width], value, L[at + j + 1 : at + width])
            for j in range(pivots):
                x[first + j, column] = own[j] / D[first + j]
            for j in range(pivots, width):
                x[rows[below + j - pivots], column] += own[j]
        for front in range(len(starts) - 2, -1, -1):
            first, pivots, below = starts[front], starts[front + 1] - starts[front], bounds[front]
            width = pivots + bounds[front + 1] - below
            for j in range(width):
                own[j] = x[first + j if j < pivots else rows[below + j - pivots], column]
            for j in range(pivots - 1, -1, -1):
                at, value = offsets[front] + j * width, own[j]
                for k in range(j + 1, width):
                    value -= L[at + k] * own[k]
                own[j] = value
            for j in range(pivots):
                x[first + j, column] = own[j]
