"""Compiled derivatives of angle defects and mixed areas, and the cotangent matrix."""

from __future__ import annotations

import numpy as np

from .._compiled import kernel
from ._kernels import corner
from .arrays import CSRIndices
from .arrays import Faces
from .arrays import FloatArray
from .arrays import PerVertex
from .arrays import Vectors
from .arrays import Vertices


@kernel(inner=True)
def face_derivatives(
    V: Vertices, F: Faces, f: int, K: PerVertex, E: FloatArray, M: FloatArray, D: FloatArray, T: FloatArray, G: FloatArray
) -> bool:
    """Write into G (3, 3, 3) what face `f` adds to the derivative of equation a by the corner b.

    ``E`` (3, 3) takes the edges, ``M`` the edges turned inwards by a right angle, ``D``
    and ``T`` (3, 3, 3) what the angles and the edge terms ``cot_c |e_c|^2`` change by.
    Returns False for a face without area.

    Angles: d theta_a / d p_b = -M_c / |e_c|^2 with c the third corner; the three at one
    corner add up to zero. Twice the area changes by M_b.
    """
    i, j, k, cx, cy, cz, double, di, dj, dk = corner(V, F, f)
    if double == 0.0:
        return False
    nx, ny, nz = cx / double, cy / double, cz / double
    for x in range(3):
        E[0, x] = V[k, x] - V[j, x]
        E[1, x] = V[i, x] - V[k, x]
        E[2, x] = V[j, x] - V[i, x]
    square = (dj + dk, di + dk, di + dj)
    dot = (di, dj, dk)
    for c in range(3):
        M[c, 0] = ny * E[c, 2] - nz * E[c, 1]
        M[c, 1] = nz * E[c, 0] - nx * E[c, 2]
        M[c, 2] = nx * E[c, 1] - ny * E[c, 0]
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        for x in range(3):
            at_b, at_c = -M[c, x] / square[c], -M[b, x] / square[b]
            D[a, b, x] = at_b
            D[a, c, x] = at_c
            D[a, a, x] = -at_b - at_c
    obtuse = -1
    for c in range(3):
        if dot[c] < 0.0:
            obtuse = c
    if obtuse < 0:
        for c in range(3):
            p, q = (c + 1) % 3, (c + 2) % 3
            cot = dot[c] / double
            turn = -square[p] * square[q] / (double * double) * square[c]
            for x in range(3):
                T[c, c, x] = turn * D[c, c, x]
                T[c, p, x] = turn * D[c, p, x] - 2.0 * cot * E[c, x]
                T[c, q, x] = turn * D[c, q, x] + 2.0 * cot * E[c, x]
    for a in range(3):
        target = K[F[f, a]]
        if obtuse < 0:
            p, q = (a + 1) % 3, (a + 2) % 3
            for b in range(3):
                for x in range(3):
                    G[a, b, x] = -D[a, b, x] - 0.125 * target * (T[p, b, x] + T[q, b, x])
        else:
            share = target * (0.25 if a == obtuse else 0.125)
            for b in range(3):
                for x in range(3):
                    G[a, b, x] = -D[a, b, x] - share * M[b, x]
    return True


def everywhere(V: Vertices, F: Faces, K: PerVertex, S: CSRIndices, size: int) -> FloatArray:
    """Return the derivatives by all coordinates, in the slots S, (size, 3)."""
    data = np.zeros((size, 3))
    _add_everywhere(V, F, K, S, *np.empty((2, 3, 3)), *np.empty((3, 3, 3, 3)), data)
    return data


@kernel()
def _add_everywhere(
    V: Vertices,
    F: Faces,
    K: PerVertex,
    S: CSRIndices,
    E: FloatArray,
    M: FloatArray,
    D: FloatArray,
    T: FloatArray,
    G: FloatArray,
    data: FloatArray,
) -> None:
    for f in range(F.shape[0]):
        if face_derivatives(V, F, f, K, E, M, D, T, G):
            for a in range(3):
                for b in range(3):
                    at = S[f, a, b]
                    if at >= 0:
                        for x in range(3):
                            data[at, x] += G[a, b, x]


def along(V: Vertices, F: Faces, K: PerVertex, S: CSRIndices, size: int, U: Vectors) -> FloatArray:
    """Return the derivatives along one direction U (n, 3) per vertex, in the slots S, (size,).

    As :func:`face_derivatives`, with every edge and every inward edge multiplied by the directions first.
    """
    data = np.zeros(size)
    _add_along(V, F, K, S, U, *np.empty((5, 3, 3)), data)
    return data


@kernel()
def _add_along(
    V: Vertices,
    F: Faces,
    K: PerVertex,
    S: CSRIndices,
    U: Vectors,
    E: FloatArray,
    turns: FloatArray,
    lengths: FloatArray,
    edge: FloatArray,
    inwards: FloatArray,
    data: FloatArray,
) -> None:
    for f in range(F.shape[0]):
        i, j, k, cx, cy, cz, double, di, dj, dk = corner(V, F, f)
        if double == 0.0:
            continue
        nx, ny, nz = cx / double, cy / double, cz / double
        for x in range(3):
            E[0, x] = V[k, x] - V[j, x]
            E[1, x] = V[i, x] - V[k, x]
            E[2, x] = V[j, x] - V[i, x]
        square = (dj + dk, di + dk, di + dj)
        dot = (di, dj, dk)
        for b in range(3):
            u = F[f, b]
            ux, uy, uz = U[u, 0], U[u, 1], U[u, 2]
            wx, wy, wz = uy * nz - uz * ny, uz * nx - ux * nz, ux * ny - uy * nx
            for c in range(3):
                edge[c, b] = E[c, 0] * ux + E[c, 1] * uy + E[c, 2] * uz
                inwards[c, b] = E[c, 0] * wx + E[c, 1] * wy + E[c, 2] * wz
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            turns[a, b] = -inwards[c, b] / square[c]
            turns[a, c] = -inwards[b, c] / square[b]
            turns[a, a] = inwards[c, a] / square[c] + inwards[b, a] / square[b]
        obtuse = -1
        for c in range(3):
            if dot[c] < 0.0:
                obtuse = c
        if obtuse < 0:
            for c in range(3):
                p, q = (c + 1) % 3, (c + 2) % 3
                twice = 2.0 * dot[c] / double
                turn = -square[p] * square[q] / (double * double) * square[c]
                lengths[c, c] = turn * turns[c, c]
                lengths[c, p] = turn * turns[c, p] - twice * edge[c, p]
                lengths[c, q] = turn * turns[c, q] + twice * edge[c, q]
        for a in range(3):
            target = K[F[f, a]]
            p, q = (a + 1) % 3, (a + 2) % 3
            for b in range(3):
                at = S[f, a, b]
                if at >= 0:
                    if obtuse < 0:
                        change = 0.125 * (lengths[p, b] + lengths[q, b])
                    else:
                        change = (0.25 if a == obtuse else 0.125) * inwards[b, b]
                    data[at] -= turns[a, b] + target * change


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
