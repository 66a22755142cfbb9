"""Compiled angles of triangles of the sphere, the plane and the hyperbolic plane, and their derivatives."""

from __future__ import annotations

import math

import numpy as np

from .._compiled import kernel
from ._kernels import corner
from .arrays import CSRIndices
from .arrays import Faces
from .arrays import FloatArray
from .arrays import PerFace
from .arrays import PerVertex
from .arrays import Vectors
from .arrays import Vertices


@kernel()
def chord(square: float, K: float) -> tuple[float, float]:
    """Return the squared chord of an arc of a squared length, and its derivative by the squared length."""
    x = math.sqrt(abs(K) * square)
    if x == 0.0:
        return square, 1.0
    if K > 0.0:
        half = math.sin(0.5 * x) / (0.5 * x)
        return square * half * half, math.sin(x) / x
    half = math.sinh(0.5 * x) / (0.5 * x)
    return square * half * half, math.sinh(x) / x


@kernel()
def sides(V: Vertices, F: Faces, f: int, K: float, arc: bool) -> tuple[float, float, float, float, float, float, float]:
    """Return the squared chords opposite the corners of face `f`, their derivatives by the squared edges, and (2 area)²."""
    _, _, _, _, _, _, double, di, dj, dk = corner(V, F, f)
    if not arc:
        return dj + dk, di + dk, di + dj, 1.0, 1.0, 1.0, double * double
    a, da = chord(dj + dk, K)
    b, db = chord(di + dk, K)
    c, dc = chord(di + dj, K)
    di, dj, dk = 0.5 * (b + c - a), 0.5 * (c + a - b), 0.5 * (a + b - c)
    return a, b, c, da, db, dc, di * dj + dj * dk + dk * di


@kernel()
def cosine(a: float, b: float, c: float, K: float) -> float:
    """Return the cosine of the angle opposite the chord a, up to the common factor of :func:`sine`."""
    return 0.5 * (b + c - a) - 0.25 * K * b * c


@kernel()
def sine(a: float, b: float, c: float, D: float, K: float) -> float:
    """Return the sine up to the factor of :func:`cosine`, the same at all corners; zero for a triangle too large for the sphere."""
    return math.sqrt(max(0.0, D - 0.25 * K * a * b * c))


@kernel()
def angle_sums(V: Vertices, F: Faces, K: PerVertex, arc: bool) -> PerVertex:
    """Return the sum of angles at every vertex (n,), each in the space form of that vertex's own K."""
    total = np.zeros(len(V))
    for f in range(F.shape[0]):
        for x in range(3):
            v = F[f, x]
            own = float(K[v])
            s0, s1, s2, _, _, _, D = sides(V, F, f, own, arc)
            square = (s0, s1, s2)
            a, b, c = square[x], square[(x + 1) % 3], square[(x + 2) % 3]
            total[v] += math.atan2(sine(a, b, c, D, own), cosine(a, b, c, own))
    return total


@kernel()
def room(V: Vertices, F: Faces, K: PerFace, arc: bool) -> PerFace:
    """Return K times the squared circumradius of every face (m,); the face fits the space form if it is less than one."""
    out = np.empty(F.shape[0])
    for f in range(F.shape[0]):
        a, b, c, _, _, _, D = sides(V, F, f, K[f], arc)
        out[f] = 0.25 * K[f] * a * b * c / D if D > 0.0 else math.inf
    return out


@kernel()
def corner_derivatives(V: Vertices, F: Faces, f: int, x: int, K: float, arc: bool, G: FloatArray) -> bool:
    """Write the derivatives of the angle at corner `x` of face `f` by the three corners into G (3, 3); return False if there is none.

    ``d theta / d a = 1 / 2S`` for the squared chord a opposite, ``- C_c / (2 S b (1 - K b / 4))`` for a side b next to it, with
    S and C the values of `sine` and `cosine`, and c the other side.
    """
    s0, s1, s2, d0, d1, d2, D = sides(V, F, f, K, arc)
    square, slope = (s0, s1, s2), (d0, d1, d2)
    y, z = (x + 1) % 3, (x + 2) % 3
    a, b, c = square[x], square[y], square[z]
    S = sine(a, b, c, D, K)
    if not S > 0.0:
        return False
    by_a = slope[x] / (2.0 * S)
    by_b = -slope[y] * cosine(c, a, b, K) / (2.0 * S * b * (1.0 - 0.25 * K * b))
    by_c = -slope[z] * cosine(b, c, a, K) / (2.0 * S * c * (1.0 - 0.25 * K * c))
    p, q, r = F[f, x], F[f, y], F[f, z]
    for k in range(3):
        # The side b joins the corners z and x, c joins x and y.
        at_a = 2.0 * by_a * (V[q, k] - V[r, k])
        at_b = 2.0 * by_b * (V[r, k] - V[p, k])
        at_c = 2.0 * by_c * (V[p, k] - V[q, k])
        G[x, k] = at_c - at_b
        G[y, k] = at_a - at_c
        G[z, k] = at_b - at_a
    return True


@kernel()
def everywhere(V: Vertices, F: Faces, K: PerVertex, S: CSRIndices, size: int, arc: bool) -> FloatArray:
    """Return the derivatives of ``2 pi`` less the angle sums by all coordinates, in the slots S, (size, 3)."""
    data = np.zeros((size, 3))
    G = np.empty((3, 3))
    for f in range(F.shape[0]):
        for a in range(3):
            if corner_derivatives(V, F, f, a, float(K[F[f, a]]), arc, G):
                for b in range(3):
                    at = S[f, a, b]
                    if at >= 0:
                        for x in range(3):
                            data[at, x] -= G[b, x]
    return data


@kernel()
def along(V: Vertices, F: Faces, K: PerVertex, S: CSRIndices, size: int, U: Vectors, arc: bool) -> FloatArray:
    """Return the same along one direction U (n, 3) per vertex, in the slots S, (size,)."""
    data = np.zeros(size)
    G = np.empty((3, 3))
    for f in range(F.shape[0]):
        for a in range(3):
            if corner_derivatives(V, F, f, a, float(K[F[f, a]]), arc, G):
                for b in range(3):
                    at = S[f, a, b]
                    if at >= 0:
                        u = F[f, b]
                        data[at] -= G[b, 0] * U[u, 0] + G[b, 1] * U[u, 1] + G[b, 2] * U[u, 2]
    return data
