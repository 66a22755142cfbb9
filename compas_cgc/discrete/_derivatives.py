"""Compiled derivatives of angle defects and mixed areas, and the cotangent matrix."""

from __future__ import annotations

import numpy as np

from .._compiled import kernel
from ._kernels import ACUTE
from ._kernels import corner
from ._kernels import obtuse_corner
from .arrays import CSRIndices
from .arrays import Faces
from .arrays import FloatArray
from .arrays import IntArray
from .arrays import PerVertex
from .arrays import Vectors
from .arrays import Vertices


@kernel(inner=True)
def rates_of(V: Vertices, F: Faces, f: int, K: PerVertex, O: IntArray, E: FloatArray, rates: FloatArray) -> bool:
    """Write into `rates` (3, 3) what face `f` adds to the derivative of equation a by the dot product d_b of the edges at b.

    ``E`` (3, 3) takes the edges, each across from its corner. With their squares ``l_a = d_b + d_c`` and twice the area
    ``D^2 = d_a d_b + d_b d_c + d_c d_a`` the angles and areas change as in `CurvatureHessian`. Returns False for a face without area.
    """
    i, j, k, _, _, _, D, di, dj, dk = corner(V, F, f)
    if D == 0.0:
        return False
    for x in range(3):
        E[0, x] = V[k, x] - V[j, x]
        E[1, x] = V[i, x] - V[k, x]
        E[2, x] = V[j, x] - V[i, x]
    d, l = (di, dj, dk), (dj + dk, di + dk, di + dj)
    obtuse = O[f] if len(O) > 0 else obtuse_corner(di, dj, dk)
    half, inverse = 0.5 / D, 1.0 / (l[0] * l[1] * l[2])
    for a in range(3):
        target, product = K[F[f, a]], d[a] * l[a]
        for b in range(3):
            grows = half * l[b]  # of the double area
            turn, lost = product * grows, d[a]
            if a == b:
                turn, lost = turn - D * l[a], l[a]
            if obtuse == ACUTE:
                change = 0.25 * (grows * (1.0 + 2.0 * half * half * product) - half * lost)
            else:
                change = (0.25 if a == obtuse else 0.125) * grows
            rates[a, b] = -turn * inverse - target * change
    return True


def everywhere(V: Vertices, F: Faces, K: PerVertex, O: IntArray, S: CSRIndices, size: int) -> FloatArray:
    """Return the derivatives by all coordinates, in the slots S, (size, 3)."""
    data = np.zeros((size, 3))
    _add_everywhere(V, F, K, O, S, *np.empty((2, 3, 3)), data)
    return data


@kernel()
def _add_everywhere(
    V: Vertices, F: Faces, K: PerVertex, O: IntArray, S: CSRIndices, E: FloatArray, rates: FloatArray, data: FloatArray
) -> None:
    for f in range(F.shape[0]):
        if rates_of(V, F, f, K, O, E, rates):
            for a in range(3):
                for b in range(3):
                    at = S[f, a, b]
                    if at >= 0:
                        p, q = (b + 1) % 3, (b + 2) % 3
                        other = rates[a, p] - rates[a, q]
                        for x in range(3):
                            data[at, x] += rates[a, b] * (E[p, x] - E[q, x]) + other * E[b, x]


def along(V: Vertices, F: Faces, K: PerVertex, O: IntArray, S: CSRIndices, size: int, U: Vectors) -> FloatArray:
    """Return the derivatives along one direction U (n, 3) per vertex, in the slots S, (size,)."""
    data = np.zeros(size)
    _add_along(V, F, K, O, S, U, *np.empty((2, 3, 3)), data)
    return data


@kernel()
def _add_along(
    V: Vertices, F: Faces, K: PerVertex, O: IntArray, S: CSRIndices, U: Vectors, E: FloatArray, rates: FloatArray, data: FloatArray
) -> None:
    for f in range(F.shape[0]):
        if rates_of(V, F, f, K, O, E, rates):
            for b in range(3):
                p, q = (b + 1) % 3, (b + 2) % 3
                own = other = 0.0  # what d_b grows by, and d_p and d_q by against each other
                for x in range(3):
                    own += (E[p, x] - E[q, x]) * U[F[f, b], x]
                    other += E[b, x] * U[F[f, b], x]
                for a in range(3):
                    at = S[f, a, b]
                    if at >= 0:
                        data[at] += rates[a, b] * own + (rates[a, p] - rates[a, q]) * other


def stiffness(V: Vertices, F: Faces, S: CSRIndices, size: int) -> FloatArray:
    """Return the negative cotangent Laplacian, in the slots S, (size,)."""
    data = np.zeros(size)
    _add_stiffness(V, F, S, data)
    return data


@kernel()
def _add_stiffness(V: Vertices, F: Faces, S: CSRIndices, data: FloatArray) -> None:
    for f in range(F.shape[0]):
        _, _, _, _, _, _, double, di, dj, dk = corner(V, F, f)
        if double == 0.0:
            continue
        dots = (di, dj, dk)
        for a in range(3):
            half = 0.5 * dots[a] / double
            for b in range(3):
                for c in range(3):
                    at = S[f, b, c]
                    if at >= 0 and b != a and c != a:
                        data[at] += half if b == c else -half
