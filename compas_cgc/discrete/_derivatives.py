"""Compiled derivatives of angle defects and mixed areas, the cotangent matrix, and the sparsity they live in."""

from __future__ import annotations

import numpy as np
from numba import njit

from ._kernels import corner
from .arrays import CSRIndices
from .arrays import Faces
from .arrays import FloatArray
from .arrays import Indices
from .arrays import PerVertex
from .arrays import Vectors
from .arrays import Vertices


@njit(cache=True)
def pattern(F: Faces, row_of: Indices, column_of: Indices, k: int) -> tuple[CSRIndices, CSRIndices]:
    """Return the CSR pattern of `k` rows: the columns among the corners of the faces around each row's vertex."""
    n = len(row_of)
    start = np.zeros(n + 1, np.int64)
    for f in range(F.shape[0]):
        for c in range(3):
            start[F[f, c] + 1] += 1
    for i in range(n):
        start[i + 1] += start[i]
    around = np.empty(start[n], np.int32)
    fill = start[:-1].copy()
    for f in range(F.shape[0]):
        for c in range(3):
            around[fill[F[f, c]]] = f
            fill[F[f, c]] += 1
    vertex_of = np.empty(k, np.int64)
    for i in range(n):
        if row_of[i] >= 0:
            vertex_of[row_of[i]] = i
    # A row has at most one column more than three per face.
    most = 0
    for r in range(k):
        most += 3 * (start[vertex_of[r] + 1] - start[vertex_of[r]])
    indices = np.empty(most, np.int32)
    indptr = np.zeros(k + 1, np.int32)
    size = 0
    for r in range(k):
        begin = size
        for a in range(start[vertex_of[r]], start[vertex_of[r] + 1]):
            for c in range(3):
                column = column_of[F[around[a], c]]
                if column < 0:
                    continue
                at = size
                while at > begin and indices[at - 1] > column:
                    at -= 1
                if at > begin and indices[at - 1] == column:
                    continue
                for b in range(size, at, -1):
                    indices[b] = indices[b - 1]
                indices[at] = column
                size += 1
        indptr[r + 1] = size
    return indptr, indices[:size].copy()


@njit(cache=True)
def slots(F: Faces, row_of: Indices, column_of: Indices, indptr: CSRIndices, indices: CSRIndices) -> CSRIndices:
    """Return where the derivative of corner a's equation by corner b's move is kept (m, 3, 3), -1 for nowhere."""
    S = np.full((F.shape[0], 3, 3), -1, np.int32)
    for f in range(F.shape[0]):
        for a in range(3):
            row = row_of[F[f, a]]
            if row < 0:
                continue
            for b in range(3):
                column = column_of[F[f, b]]
                if column >= 0:
                    at = indptr[row]
                    while indices[at] != column:
                        at += 1
                    S[f, a, b] = at
    return S


@njit(cache=True)
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


@njit(cache=True, error_model="numpy")
def everywhere(V: Vertices, F: Faces, K: PerVertex, S: CSRIndices, size: int) -> FloatArray:
    """Return the derivatives by all coordinates, in the slots S, (size, 3)."""
    data = np.zeros((size, 3))
    E, M = np.empty((3, 3)), np.empty((3, 3))
    D, T, G = np.empty((3, 3, 3)), np.empty((3, 3, 3)), np.empty((3, 3, 3))
    for f in range(F.shape[0]):
        if face_derivatives(V, F, f, K, E, M, D, T, G):
            for a in range(3):
                for b in range(3):
                    at = S[f, a, b]
                    if at >= 0:
                        for x in range(3):
                            data[at, x] += G[a, b, x]
    return data


@njit(cache=True, error_model="numpy")
def along(V: Vertices, F: Faces, K: PerVertex, S: CSRIndices, size: int, U: Vectors) -> FloatArray:
    """Return the derivatives along one direction U (n, 3) per vertex, in the slots S, (size,)."""
    data = np.zeros(size)
    E, M = np.empty((3, 3)), np.empty((3, 3))
    D, T, G = np.empty((3, 3, 3)), np.empty((3, 3, 3)), np.empty((3, 3, 3))
    for f in range(F.shape[0]):
        if face_derivatives(V, F, f, K, E, M, D, T, G):
            for a in range(3):
                for b in range(3):
                    at = S[f, a, b]
                    if at >= 0:
                        u = F[f, b]
                        data[at] += G[a, b, 0] * U[u, 0] + G[a, b, 1] * U[u, 1] + G[a, b, 2] * U[u, 2]
    return data


@njit(cache=True)
def stiffness(V: Vertices, F: Faces, S: CSRIndices, size: int) -> FloatArray:
    """Return the negative cotangent Laplacian, in the slots S, (size,)."""
    data = np.zeros(size)
    for f in range(F.shape[0]):
        _, _, _, _, _, _, double, di, dj, dk = corner(V, F, f)
        if double == 0.0:
            continue
        dots = (di, dj, dk)
        for a in range(3):
            p, q = (a + 1) % 3, (a + 2) % 3
            half = 0.5 * dots[a] / double
            if S[f, p, p] >= 0:
                data[S[f, p, p]] += half
            if S[f, q, q] >= 0:
                data[S[f, q, q]] += half
            if S[f, p, q] >= 0:
                data[S[f, p, q]] -= half
            if S[f, q, p] >= 0:
                data[S[f, q, p]] -= half
    return data
