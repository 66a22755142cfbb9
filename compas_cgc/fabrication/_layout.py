"""Compiled layout of triangles in a space form: a rigid frame moves from face to face."""

from __future__ import annotations

import math

import numpy as np

from .._compiled import kernel
from ..discrete._space_form import cosine
from ..discrete._space_form import sides
from ..discrete._space_form import sine
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..discrete.arrays import IntArray
from ..discrete.arrays import Vertices


@kernel(inner=True)
def moved(Q: FloatArray, square: float, K: float, sign: float) -> None:
    """Move a frame along its first axis, forwards (sign 1) or backwards (-1), by a chord of squared length `square`."""
    c = 1.0 - 0.5 * K * square
    s = sign * math.sqrt(square * max(0.0, 1.0 - 0.25 * K * square))
    for i in range(3):
        origin, ahead = Q[i, 0], Q[i, 1]
        Q[i, 0] = origin * c + ahead * s
        Q[i, 1] = ahead * c - K * s * origin


@kernel(inner=True)
def turned(Q: FloatArray, c: float, s: float) -> None:
    """Rotate a frame about its origin by the angle with cosine c and sine s."""
    for i in range(3):
        ahead, left = Q[i, 1], Q[i, 2]
        Q[i, 1] = ahead * c + left * s
        Q[i, 2] = left * c - ahead * s


@kernel(inner=True)
def triangle(V: Vertices, F: Faces, f: int, K: float, arc: bool, out: FloatArray) -> None:
    """Write the squared opposite chord, the cosine and the sine of every corner of a face into `out` (3, 3)."""
    a, b, c, _, _, _, D = sides(V, F, f, K, arc)
    square = (a, b, c)
    for x in range(3):
        p, q, r = square[x], square[(x + 1) % 3], square[(x + 2) % 3]
        C, S = cosine(p, q, r, K), sine(p, q, r, D, K)
        long = math.hypot(C, S)
        out[x, 0], out[x, 1], out[x, 2] = p, C / long if long > 0.0 else 1.0, S / long if long > 0.0 else 0.0


@kernel()
def laid(V: Vertices, F: Faces, order: Indices, before: Indices, side: IntArray, K: float, arc: bool) -> FloatArray:
    """Return the corner points of faces (m, 3, 3), each face laid beside its predecessor.

    ``order`` (m,) lists the faces in the order of layout, ``before`` (m,) the predecessor of each (-1 for the first), and
    ``side`` (m, 2) the corners opposite the shared edge in the predecessor and in the face.
    """
    m = F.shape[0]
    frames = np.zeros((m, 3, 3))  # at corner 0, towards corner 1
    points = np.empty((m, 3, 3))
    T = np.empty((3, 3))
    for k in range(len(order)):
        f = order[k]
        Q = frames[f]
        if before[f] < 0:
            for i in range(3):
                Q[i, i] = 1.0
        else:
            # Walk along the predecessor to the shared edge, cross it, and walk along the face back to corner 0.
            g = int(before[f])
            Q[:, :] = frames[g]
            triangle(V, F, g, K, arc, T)
            for x in range((side[f, 0] + 1) % 3):
                moved(Q, T[(x + 2) % 3, 0], K, 1.0)
                turned(Q, -T[(x + 1) % 3, 1], T[(x + 1) % 3, 2])
            moved(Q, T[side[f, 0], 0], K, 1.0)
            turned(Q, -1.0, 0.0)
            triangle(V, F, f, K, arc, T)
            for x in range((side[f, 1] + 1) % 3 - 1, -1, -1):
                turned(Q, -T[(x + 1) % 3, 1], -T[(x + 1) % 3, 2])
                moved(Q, T[(x + 2) % 3, 0], K, -1.0)
        triangle(V, F, f, K, arc, T)
        Q = frames[f].copy()
        for x in range(3):
            for i in range(3):
                points[f, x, i] = Q[i, 0]
            moved(Q, T[(x + 2) % 3, 0], K, 1.0)
            turned(Q, -T[(x + 1) % 3, 1], T[(x + 1) % 3, 2])
    return points
