"""Compiled second derivatives of angle defects and mixed areas: of the defects applied to a move, of both as the entries of a matrix."""

from __future__ import annotations

import math

import numpy as np

from .._compiled import kernel
from .arrays import CSRIndices
from .arrays import Faces
from .arrays import FloatArray
from .arrays import PerVertex
from .arrays import Vectors
from .arrays import Vertices


@kernel()
def defects_along(V: Vertices, F: Faces, weight: PerVertex, U: Vectors) -> Vectors:
    """Return the derivative (n, 3), along the move U (n, 3), of the gradient of the weighted sum of all angle defects.

    The angle at a corner a changes by ``-M_c / |e_c|^2`` when the corner b moves, with ``e_c`` the
    edge opposite the third corner c and ``M_c = n x e_c``; here each of these is differentiated along U.
    """
    out = np.zeros(V.shape)
    E, DE, M, DM, Q = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for f in range(F.shape[0]):
        if weight[F[f, 0]] == 0.0 and weight[F[f, 1]] == 0.0 and weight[F[f, 2]] == 0.0:
            continue
        for c in range(3):
            p, q = F[f, (c + 1) % 3], F[f, (c + 2) % 3]
            for x in range(3):
                E[c, x] = V[q, x] - V[p, x]
                DE[c, x] = U[q, x] - U[p, x]
        double, _ = turned_edges(E, DE, M, DM)
        if double == 0.0:
            continue
        write_turns(E, DE, M, DM, Q)
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            w = weight[F[f, a]]
            for x in range(3):
                out[F[f, b], x] += w * Q[c, x]
                out[F[f, c], x] += w * Q[b, x]
                out[F[f, a], x] -= w * (Q[b, x] + Q[c, x])
    return out


@kernel()
def entries(V: Vertices, F: Faces, weight: PerVertex, K: PerVertex, S: CSRIndices, size: int) -> FloatArray:
    """Return the second derivatives of the weighted sum of ``defect - K area``, in the slots S, (size, 3, 3).

    Mixed areas are ``Σ cot_c |e_c|^2 / 8`` over the corners c that are not the vertex, or shares of a face with an obtuse angle.
    """
    data = np.zeros((size, 3, 3))
    E, DE, M, DM, Q, R = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    w, share = np.empty(3), np.empty(3)
    for f in range(F.shape[0]):
        if weight[F[f, 0]] == 0.0 and weight[F[f, 1]] == 0.0 and weight[F[f, 2]] == 0.0:
            continue
        for c in range(3):
            w[c] = weight[F[f, c]]
            p, q = F[f, (c + 1) % 3], F[f, (c + 2) % 3]
            for x in range(3):
                E[c, x] = V[q, x] - V[p, x]
        obtuse = -1
        for c in range(3):
            p, q = (c + 1) % 3, (c + 2) % 3
            share[c] = 0.125 * (w[p] * K[F[f, p]] + w[q] * K[F[f, q]])
            if E[p, 0] * E[q, 0] + E[p, 1] * E[q, 1] + E[p, 2] * E[q, 2] > 0.0:
                obtuse = c
        cell = 0.0
        for a in range(3):
            cell += w[a] * K[F[f, a]] * (0.25 if a == obtuse else 0.125)
        for b in range(3):
            for y in range(3):
                for c in range(3):
                    for x in range(3):
                        DE[c, x] = 0.0
                DE[(b + 1) % 3, y], DE[(b + 2) % 3, y] = 1.0, -1.0
                double, growth = turned_edges(E, DE, M, DM)
                if double == 0.0:
                    continue
                for c in range(3):
                    for x in range(3):
                        R[c, x] = -cell * DM[c, x] if obtuse >= 0 else 0.0
                if obtuse < 0:
                    subtract_cells(E, DE, M, DM, double, growth, share, R)
                write_turns(E, DE, M, DM, Q)
                for a in range(3):
                    p, q = (a + 1) % 3, (a + 2) % 3
                    for x in range(3):
                        R[p, x] += w[a] * Q[q, x]
                        R[q, x] += w[a] * Q[p, x]
                        R[a, x] -= w[a] * (Q[p, x] + Q[q, x])
                for a in range(3):
                    at = S[f, a, b]
                    if at >= 0:
                        for x in range(3):
                            data[at, x, y] += R[a, x]
    return data


@kernel(inner=True)
def turned_edges(E: FloatArray, DE: FloatArray, M: FloatArray, DM: FloatArray) -> tuple[float, float]:
    """Write the edges (3, 3) of a face turned inwards by a right angle, and their change; return twice its area and the change of that."""
    nx, ny, nz = E[0, 1] * E[1, 2] - E[0, 2] * E[1, 1], E[0, 2] * E[1, 0] - E[0, 0] * E[1, 2], E[0, 0] * E[1, 1] - E[0, 1] * E[1, 0]
    dx = DE[0, 1] * E[1, 2] - DE[0, 2] * E[1, 1] + E[0, 1] * DE[1, 2] - E[0, 2] * DE[1, 1]
    dy = DE[0, 2] * E[1, 0] - DE[0, 0] * E[1, 2] + E[0, 2] * DE[1, 0] - E[0, 0] * DE[1, 2]
    dz = DE[0, 0] * E[1, 1] - DE[0, 1] * E[1, 0] + E[0, 0] * DE[1, 1] - E[0, 1] * DE[1, 0]
    double = math.sqrt(nx * nx + ny * ny + nz * nz)
    if double == 0.0:
        return 0.0, 0.0
    nx, ny, nz = nx / double, ny / double, nz / double
    growth = nx * dx + ny * dy + nz * dz
    dx, dy, dz = (dx - growth * nx) / double, (dy - growth * ny) / double, (dz - growth * nz) / double
    for c in range(3):
        M[c, 0], M[c, 1], M[c, 2] = ny * E[c, 2] - nz * E[c, 1], nz * E[c, 0] - nx * E[c, 2], nx * E[c, 1] - ny * E[c, 0]
        DM[c, 0] = dy * E[c, 2] - dz * E[c, 1] + ny * DE[c, 2] - nz * DE[c, 1]
        DM[c, 1] = dz * E[c, 0] - dx * E[c, 2] + nz * DE[c, 0] - nx * DE[c, 2]
        DM[c, 2] = dx * E[c, 1] - dy * E[c, 0] + nx * DE[c, 1] - ny * DE[c, 0]
    return double, growth


@kernel(inner=True)
def write_turns(E: FloatArray, DE: FloatArray, M: FloatArray, DM: FloatArray, Q: FloatArray) -> None:
    """Write the changes of ``M_c / |e_c|^2`` into Q (3, 3), see :func:`defects_along`."""
    for c in range(3):
        length = E[c, 0] * E[c, 0] + E[c, 1] * E[c, 1] + E[c, 2] * E[c, 2]
        change = 2.0 * (E[c, 0] * DE[c, 0] + E[c, 1] * DE[c, 1] + E[c, 2] * DE[c, 2]) / length
        for x in range(3):
            Q[c, x] = (DM[c, x] - M[c, x] * change) / length


@kernel(inner=True)
def subtract_cells(
    E: FloatArray, DE: FloatArray, M: FloatArray, DM: FloatArray, double: float, growth: float, share: FloatArray, R: FloatArray
) -> None:
    """Subtract the change of the gradient of shares of ``N_c / D`` from R (3, 3), with D twice the area and ``N_c = D cot_c |e_c|^2``."""
    for c in range(3):
        p, q = (c + 1) % 3, (c + 2) % 3
        dot = square = turn = stretch = 0.0
        for x in range(3):
            dot -= E[p, x] * E[q, x]
            square += E[c, x] * E[c, x]
            turn -= DE[p, x] * E[q, x] + E[p, x] * DE[q, x]
            stretch += 2.0 * E[c, x] * DE[c, x]
        N, DN = dot * square, turn * square + dot * stretch
        g, rate = share[c] / double, growth / double
        for x in range(3):
            # Of the dot product of the edges that meet at c, and of the squared length of the one across.
            at_p, at_q, across = -E[p, x], E[q, x], 2.0 * E[c, x]
            d_p, d_q, d_across = -DE[p, x], DE[q, x], 2.0 * DE[c, x]
            R[c, x] += g * ((d_p + d_q) * square + (at_p + at_q) * stretch - (at_p + at_q) * square * rate)
            R[p, x] -= g * (
                d_p * square + at_p * stretch - turn * across - dot * d_across - (at_p * square - dot * across) * growth / double
            )
            R[q, x] -= g * (
                d_q * square + at_q * stretch + turn * across + dot * d_across - (at_q * square + dot * across) * growth / double
            )
            for b in range(3):
                R[b, x] += g / double * (DN * M[b, x] + N * DM[b, x] - 2.0 * N * M[b, x] * rate)
