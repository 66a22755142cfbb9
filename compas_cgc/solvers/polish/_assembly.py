"""Compiled sums of what the faces of a cell and its equation contribute to the second derivatives, and where they are stored."""

from __future__ import annotations

import numpy as np

from ..._compiled import kernel
from ...discrete.arrays import CSRIndices
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray

__all__ = ["add_cells", "slots"]


@kernel()
def add_cells(
    faces: IntArray,
    places: IntArray,
    owned: FloatArray,
    row: IntArray,
    even: FloatArray,
    convex: FloatArray,
    curved: FloatArray,
    slopes: FloatArray,
    shape_slopes: FloatArray,
    rows: FloatArray,
    row_curvature: FloatArray,
    slots: IntArray,
    line_slots: IntArray,
    G: FloatArray,
    D: FloatArray,
    C: FloatArray,
    H: FloatArray,
    pulled: FloatArray,
    convex_data: FloatArray,
    curved_data: FloatArray,
    line_data: FloatArray,
) -> None:
    """Add the second derivatives of cells of k faces and w unknowns, and the derivatives of their equations, to sparse entries.

    Faces (g, k), places (g, k, 6) of their unknowns among those of the cell, and entries of the sparse matrix (g, w, w) and of its
    rows (g, w), -1 for none. `even` (g, k, k) is empty where nothing is evened out. G (w, 7), D (6k, w), C, H (w, w) and `pulled`
    (w, 7) are room to work in; what faces contribute is that of ``Parts``, `shape_slopes` times the root of their weights.
    """
    cells, k = faces.shape
    w = C.shape[0]
    evens = even.shape[0] > 0
    for g in range(cells):
        for p in range(w):
            for q in range(w):
                C[p, q] = H[p, q] = 0.0
            for e in range(7):
                G[p, e] = 0.0
        for j in range(k):
            f, part = faces[g, j], owned[g, j]
            for a in range(6):
                p = places[g, j, a]
                for e in range(7):
                    G[p, e] += slopes[f, e, a]
                if part != 0.0:
                    for b in range(6):
                        q = places[g, j, b]
                        C[p, q] += convex[f, a, b]
                        H[p, q] += curved[f, a, b]
        if evens:
            for i in range(6 * k):
                for p in range(w):
                    D[i, p] = 0.0
            for i in range(k):
                for j in range(k):
                    f, weight = faces[g, j], even[g, i, j]
                    for e in range(6):
                        for a in range(6):
                            D[6 * i + e, places[g, j, a]] += weight * shape_slopes[f, e, a]
            for i in range(6 * k):
                for p in range(w):
                    d = D[i, p]
                    if d != 0.0:
                        for q in range(w):
                            C[p, q] += d * D[i, q]
        r = row[g]
        if r >= 0:
            for p in range(w):
                value = 0.0
                for e in range(7):
                    value += G[p, e] * rows[r, e]
                    total = 0.0
                    for h in range(7):
                        total += G[p, h] * row_curvature[r, h, e]
                    pulled[p, e] = total
                at = line_slots[g, p]
                if at >= 0:
                    line_data[at] += value
            for p in range(w):
                for q in range(w):
                    total = 0.0
                    for e in range(7):
                        total += pulled[p, e] * G[q, e]
                    H[p, q] += total
        for p in range(w):
            for q in range(w):
                at = slots[g, p, q]
                if at >= 0:
                    convex_data[at] += C[p, q]
                    curved_data[at] += H[p, q]


@kernel()
def slots(indptr: CSRIndices, indices: CSRIndices, rows: IntArray, columns: IntArray) -> IntArray:
    """Return where a sparse matrix stores the entries of rows (g, a) and columns (g, b) of cells (g, a, b), -1 for none."""
    found = np.full((rows.shape[0], rows.shape[1], columns.shape[1]), -1)
    for g in range(rows.shape[0]):
        for i in range(rows.shape[1]):
            r = rows[g, i]
            if r >= 0:
                for j in range(columns.shape[1]):
                    c = columns[g, j]
                    low, high = indptr[r], indptr[r + 1]
                    while high - low > 1:
                        middle = (low + high) // 2
                        if indices[middle] <= c:
                            low = middle
                        else:
                            high = middle
                    if c >= 0:
                        found[g, i, j] = low
    return found
