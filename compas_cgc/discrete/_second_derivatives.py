"""Compiled second derivatives of angle defects, applied to a move."""

from __future__ import annotations

import math

import numpy as np

from .._compiled import kernel
from .arrays import Faces
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
    E, DE, Q = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    n, dn = np.empty(3), np.empty(3)
    for f in range(F.shape[0]):
        if weight[F[f, 0]] == 0.0 and weight[F[f, 1]] == 0.0 and weight[F[f, 2]] == 0.0:
            continue
        for c in range(3):
            p, q = F[f, (c + 1) % 3], F[f, (c + 2) % 3]
            for x in range(3):
                E[c, x] = V[q, x] - V[p, x]
                DE[c, x] = U[q, x] - U[p, x]
        square = 0.0
        for x in range(3):
            y, z = (x + 1) % 3, (x + 2) % 3
            n[x] = E[0, y] * E[1, z] - E[0, z] * E[1, y]
            dn[x] = DE[0, y] * E[1, z] - DE[0, z] * E[1, y] + E[0, y] * DE[1, z] - E[0, z] * DE[1, y]
            square += n[x] * n[x]
        if square == 0.0:
            continue
        double = math.sqrt(square)
        along = (n[0] * dn[0] + n[1] * dn[1] + n[2] * dn[2]) / square
        for x in range(3):
            dn[x] = (dn[x] - along * n[x]) / double
            n[x] /= double
        for c in range(3):
            length = E[c, 0] * E[c, 0] + E[c, 1] * E[c, 1] + E[c, 2] * E[c, 2]
            change = 2.0 * (E[c, 0] * DE[c, 0] + E[c, 1] * DE[c, 1] + E[c, 2] * DE[c, 2]) / length
            for x in range(3):
                y, z = (x + 1) % 3, (x + 2) % 3
                M = n[y] * E[c, z] - n[z] * E[c, y]
                DM = dn[y] * E[c, z] - dn[z] * E[c, y] + n[y] * DE[c, z] - n[z] * DE[c, y]
                Q[c, x] = (DM - M * change) / length
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            w = weight[F[f, a]]
            for x in range(3):
                out[F[f, b], x] += w * Q[c, x]
                out[F[f, c], x] += w * Q[b, x]
                out[F[f, a], x] -= w * (Q[b, x] + Q[c, x])
    return out
