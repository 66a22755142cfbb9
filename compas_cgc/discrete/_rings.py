"""Rings of faces around vertices, and monomials over them, for compiled fits."""

from __future__ import annotations

import numpy as np

from .._compiled import kernel
from .arrays import Faces
from .arrays import FloatArray
from .arrays import IntArray
from .arrays import Mask

MOST = 400  # vertices in the rings of one fit; a fan with more is a pole, where a part of the ring suffices


def around(F: Faces, n: int) -> tuple[IntArray, IntArray]:
    """Return the faces at every vertex: row pointers (n + 1,) and face indices."""
    start = np.concatenate([[0], np.cumsum(np.bincount(F.ravel(), minlength=n))])
    return start, np.argsort(F.ravel(), kind="stable") // 3


@kernel(inner=True)
def gather(i: int, F: Faces, start: IntArray, faces: IntArray, through: Mask, rings: int, ring: IntArray, stamp: IntArray) -> int:
    """Write the vertices of the rings around i into `ring`, continued through vertices of `through` only; return their number."""
    stamp[i] = i
    count, done, end = 0, 0, 0
    for level in range(rings):
        for k in range(done - 1 if level == 0 else done, end):
            j = i if level == 0 else ring[k]
            if level > 0 and not through[j]:
                continue
            for a in range(start[j], start[j + 1]):
                for c in range(3):
                    m = F[faces[a], c]
                    if stamp[m] != i and count < MOST:
                        stamp[m] = i
                        ring[count] = m
                        count += 1
        done, end = end, count
    return count


@kernel(inner=True)
def monomials(u: float, v: float, degree: int, row: FloatArray) -> None:
    """Write the monomials of degree 1 to `degree` into a row, u before v."""
    row[0], row[1] = u, v
    before, at = 0, 2
    for total in range(2, degree + 1):
        for q in range(total):
            row[at + q] = u * row[before + q]
        row[at + total] = v * row[at - 1]
        before, at = at, at + total + 1
