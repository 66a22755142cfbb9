"""Compiled polynomial fits around vertices, and what they say about angle defects."""

from __future__ import annotations

import math

import numpy as np

from .._compiled import kernel
from ._cholesky import solve_in_place
from .arrays import Faces
from .arrays import FloatArray
from .arrays import IntArray
from .arrays import Mask
from .arrays import Vectors
from .arrays import Vertices

MOST = 400  # vertices in the rings of one fit
TERMS = np.array([0, 2, 5, 9, 14])  # of a polynomial of each degree, without the constant
SPARE = 1.25  # points against terms below which the degree is lowered
CENTRED = 0.2  # what a point's squared distance, against the farthest, is added to in its weight


@kernel()
def around(F: Faces, n: int) -> tuple[IntArray, IntArray]:
    """Return the faces at every vertex, in compressed rows."""
    start = np.zeros(n + 1, np.int64)
    for f in range(F.shape[0]):
        for c in range(3):
            start[F[f, c] + 1] += 1
    for i in range(n):
        start[i + 1] += start[i]
    fill = start[:-1].copy()
    faces = np.empty(start[n], np.int64)
    for f in range(F.shape[0]):
        for c in range(3):
            faces[fill[F[f, c]]] = f
            fill[F[f, c]] += 1
    return start, faces


@kernel()
def gather(i: int, F: Faces, start: IntArray, faces: IntArray, through: Mask, rings: int, ring: IntArray, stamp: IntArray) -> int:
    """Write the vertices of the rings around i into `ring`, reached through vertices of `through` only; return how many."""
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


@kernel()
def powers(u: float, v: float, degree: int, row: FloatArray) -> None:
    """Write the monomials of degree 1 to `degree` into a row, u before v."""
    at = 0
    for total in range(1, degree + 1):
        for q in range(total + 1):
            row[at] = u ** (total - q) * v**q
            at += 1


@kernel()
def corner_of(a: FloatArray, b: FloatArray) -> tuple[float, float]:
    """Return the angle between two sides at a vertex, and its share of the mixed area."""
    x, y, z = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
    double = math.sqrt(x * x + y * y + z * z)
    dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    aa, bb = a[0] * a[0] + a[1] * a[1] + a[2] * a[2], b[0] * b[0] + b[1] * b[1] + b[2] * b[2]
    if dot < 0.0:
        area = 0.25 * double
    elif aa < dot or bb < dot:
        area = 0.125 * double
    else:
        area = 0.125 * (aa * (bb - dot) + bb * (aa - dot)) / double if double > 0.0 else 0.0
    return math.atan2(double, dot), area


@kernel()
def misfit(points: FloatArray, count: int, scale: float, r: FloatArray, degree: int, row: FloatArray) -> tuple[float, float]:
    """Return how far points lie from a polynomial, and how far its quadratic part leads them, both as root mean squares."""
    terms = TERMS[degree]
    if count < terms + 2:
        return np.nan, np.nan
    off, bent = 0.0, 0.0
    for c in range(count):
        powers(points[c, 0] / scale, points[c, 1] / scale, degree, row)
        height, second = -points[c, 2] / scale, 0.0
        for k in range(terms):
            height += r[k] * row[k]
        for k in range(2, 5):
            second += r[k] * row[k]
        off += height * height
        bent += second * second
    return scale * math.sqrt(off / (count - terms)), scale * math.sqrt(bent / count)


@kernel()
def fitted(
    V: Vertices,
    N: Vectors,
    F: Faces,
    start: IntArray,
    faces: IntArray,
    through: Mask,
    wanted: Mask,
    degree: int,
    rings: int,
    pinned: bool,
) -> FloatArray:
    """Return what polynomials around the wanted vertices tell (n, 6), else NaN: the columns of `LocalFits`."""
    out = np.full((V.shape[0], 6), np.nan)
    ring, stamp = np.empty(MOST, np.int64), np.full(V.shape[0], -1)
    place = np.full(V.shape[0], -1)
    most = TERMS[degree]
    points = np.empty((MOST, 3))
    M, r, row = np.empty((most + 1, most + 1)), np.empty(most + 1), np.empty(most + 1)
    p, q = np.empty(3), np.empty(3)
    for i in range(V.shape[0]):
        if not wanted[i]:
            continue
        count = gather(i, F, start, faces, through, rings, ring, stamp)
        used = degree
        while used > 2 and count < SPARE * TERMS[used]:
            used -= 1
        terms = TERMS[used]
        n0, n1, n2 = N[i]
        if count < terms or n0 * n0 + n1 * n1 + n2 * n2 == 0.0:
            continue
        # A frame with the normal as its third axis.
        x0, x1, x2 = 0.0, n2, -n1
        if abs(n0) > abs(n1) or abs(n0) > abs(n2):
            x0, x1, x2 = (-n2, 0.0, n0) if abs(n1) <= abs(n2) else (n1, -n0, 0.0)
        length = math.sqrt(x0 * x0 + x1 * x1 + x2 * x2)
        x0, x1, x2 = x0 / length, x1 / length, x2 / length
        y0, y1, y2 = n1 * x2 - n2 * x1, n2 * x0 - n0 * x2, n0 * x1 - n1 * x0
        scale = 0.0
        for c in range(count):
            d0, d1, d2 = V[ring[c], 0] - V[i, 0], V[ring[c], 1] - V[i, 1], V[ring[c], 2] - V[i, 2]
            points[c, 0], points[c, 1], points[c, 2] = d0 * x0 + d1 * x1 + d2 * x2, d0 * y0 + d1 * y1 + d2 * y2, d0 * n0 + d1 * n1 + d2 * n2
            scale = max(scale, d0 * d0 + d1 * d1 + d2 * d2)
            place[ring[c]] = c
        scale = math.sqrt(scale)
        if scale == 0.0:
            continue
        M[:] = 0.0
        r[:] = 0.0
        for c in range(count):
            u, v, w = points[c, 0] / scale, points[c, 1] / scale, points[c, 2] / scale
            powers(u, v, used, row)
            weight = 1.0 / (u * u + v * v + CENTRED)
            for k in range(terms):
                r[k] += weight * row[k] * w
                for m in range(k + 1):
                    M[k, m] += weight * row[k] * row[m]
        level = 0.0
        if pinned:
            solve_in_place(M, r, terms, 0.0)
        else:
            # The last unknown is the height of the polynomial over the vertex, which is one of the points.
            total = 1.0 / CENTRED
            M[terms, : terms + 1] = 0.0
            r[terms] = 0.0
            for c in range(count):
                u, v, w = points[c, 0] / scale, points[c, 1] / scale, points[c, 2] / scale
                powers(u, v, used, row)
                weight = 1.0 / (u * u + v * v + CENTRED)
                total += weight
                r[terms] += weight * w
                for k in range(terms):
                    M[terms, k] += weight * row[k]
            M[terms, terms] = total
            solve_in_place(M, r, terms + 1, 0.0)
            level = r[terms]
        for c in range(count):
            points[c, 2] -= level * scale
        a, b = r[0], r[1]
        uu, uv, vv = 2.0 * r[2], r[3], 2.0 * r[4]
        g = 1.0 + a * a + b * b
        out[i, 0] = (uu * vv - uv * uv) / (g * g) / (scale * scale)
        out[i, 1] = -((1 + b * b) * uu - 2 * a * b * uv + (1 + a * a) * vv) / (2 * g * math.sqrt(g)) / scale
        out[i, 3], out[i, 4] = misfit(points, count, scale, r, used, row)
        out[i, 5] = scale
        defect, area = 2.0 * math.pi, 0.0
        for k in range(start[i], start[i + 1]):
            f = faces[k]
            c = 0 if F[f, 0] == i else (1 if F[f, 1] == i else 2)
            j, m = place[F[f, (c + 1) % 3]], place[F[f, (c + 2) % 3]]
            p[0], p[1], q[0], q[1] = points[j, 0] / scale, points[j, 1] / scale, points[m, 0] / scale, points[m, 1] / scale
            p[2], q[2] = 0.0, 0.0
            powers(p[0], p[1], used, row)
            for t in range(terms):
                p[2] += r[t] * row[t]
            powers(q[0], q[1], used, row)
            for t in range(terms):
                q[2] += r[t] * row[t]
            angle, share = corner_of(p, q)
            defect -= angle
            area += share
        if area > 0.0:
            out[i, 2] = defect / area / (scale * scale) - out[i, 0]
    return out
