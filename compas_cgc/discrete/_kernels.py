"""Compiled kernels over faces and edges; `F`, `V` are checked before they get here."""

from __future__ import annotations

import math

import numpy as np

from .._compiled import kernel
from .arrays import Edges
from .arrays import Faces
from .arrays import IntArray
from .arrays import PerFace
from .arrays import PerVertex
from .arrays import Vectors
from .arrays import Vertices

MIXED = 0  # label of mixed cells; by definition
VORONOI = 1  # label of Voronoi cells; by definition
BARYCENTRIC = 2  # label of barycentric cells; by definition
AS_IT_IS: IntArray = np.zeros(0, np.int64)  # in place of the corners with obtuse angles: those that the shape has
ACUTE = -1  # label of a face without an obtuse angle, instead of the corner of this angle; by definition


@kernel(inner=True)
def corner(V: Vertices, F: Faces, f: int) -> tuple[int, int, int, float, float, float, float, float, float, float]:
    """Return the indices of face `f`, its cross vector (twice the vector area) and what follows from it.

    ``ij``, ``jk``, ``ki`` are the dot products of the two edges that meet at i, j, k.
    """
    i, j, k = F[f, 0], F[f, 1], F[f, 2]
    ax, ay, az = V[j, 0] - V[i, 0], V[j, 1] - V[i, 1], V[j, 2] - V[i, 2]
    bx, by, bz = V[k, 0] - V[i, 0], V[k, 1] - V[i, 1], V[k, 2] - V[i, 2]
    cx, cy, cz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    aa = ax * ax + ay * ay + az * az
    bb = bx * bx + by * by + bz * bz
    ab = ax * bx + ay * by + az * bz
    return i, j, k, cx, cy, cz, math.sqrt(cx * cx + cy * cy + cz * cz), ab, aa - ab, bb - ab


@kernel(inner=True)
def obtuse_corner(di: float, dj: float, dk: float) -> int:
    """Return the corner, 0 to 2, at which a face has an obtuse angle, -1 if there is none."""
    if di < 0.0:
        return 0
    if dj < 0.0:
        return 1
    return 2 if dk < 0.0 else ACUTE


@kernel(inner=True)
def cell_areas(kind: int, obtuse: int, double: float, di: float, dj: float, dk: float) -> tuple[float, float, float]:
    """Return the shares of a face's area that belong to its corners i, j, k.

    Voronoi: (cot_j |ik|^2 + cot_k |ij|^2) / 8, with cot = dot / double area. Mixed: the
    same, but half and quarters of the face where it is obtuse (Meyer et al. 2003).
    """
    if kind == BARYCENTRIC or double == 0.0:
        third = double / 6.0
        return third, third, third
    if kind == MIXED:
        if obtuse == 0:
            return 0.25 * double, 0.125 * double, 0.125 * double
        if obtuse == 1:
            return 0.125 * double, 0.25 * double, 0.125 * double
        if obtuse == 2:
            return 0.125 * double, 0.125 * double, 0.25 * double
    eighth = 0.125 / double
    # Squared lengths of the edges: |ij|^2 = di + dj and so on.
    si, sj, sk = dk * (di + dj), dj * (di + dk), di * (dj + dk)
    return (si + sj) * eighth, (si + sk) * eighth, (sj + sk) * eighth


def angle_sums_and_areas(V: Vertices, F: Faces, kind: int, obtuse: IntArray = AS_IT_IS) -> tuple[PerVertex, PerVertex]:
    """Return the sum of angles (n,) and the cell area (n,) at every vertex in one pass, for Eq. 10.

    Corners with an obtuse angle (m,), see :func:`obtuse_corner`, may be those of another shape.
    """
    angle, area = np.zeros(len(V)), np.zeros(len(V))
    _add_angles_and_areas(V, F, kind, obtuse, angle, area)
    return angle, area


@kernel()
def _add_angles_and_areas(V: Vertices, F: Faces, kind: int, O: IntArray, angle: PerVertex, area: PerVertex) -> None:
    for f in range(F.shape[0]):
        i, j, k, _, _, _, double, di, dj, dk = corner(V, F, f)
        ti = math.atan2(double, di)
        tj = math.atan2(double, dj)
        angle[i] += ti
        angle[j] += tj
        angle[k] += math.pi - ti - tj
        obtuse = O[f] if len(O) > 0 else obtuse_corner(di, dj, dk)
        ai, aj, ak = cell_areas(kind, obtuse, double, di, dj, dk)
        area[i] += ai
        area[j] += aj
        area[k] += ak


@kernel()
def write_cross_vectors(V: Vertices, F: Faces, C: Vectors) -> None:
    """Write twice the vector area of every face into the first rows of C."""
    for f in range(F.shape[0]):
        _, _, _, C[f, 0], C[f, 1], C[f, 2], _, _, _, _ = corner(V, F, f)


def cross_vectors(V: Vertices, F: Faces) -> Vectors:
    """Return twice the vector area of every face, which is that of Eq. 11 (m, 3)."""
    C = np.empty((F.shape[0], 3))
    write_cross_vectors(V, F, C)
    return C


def sum_at_vertices(n: int, F: Faces, C: Vectors) -> Vectors:
    """Return the sum of the face vectors `C` around every vertex, Eq. 12 (n, 3)."""
    N = np.zeros((n, 3))
    _add_at_vertices(F, C, N)
    return N


@kernel()
def _add_at_vertices(F: Faces, C: Vectors, N: Vectors) -> None:
    for f in range(F.shape[0]):
        for c in range(3):
            for x in range(3):
                N[F[f, c], x] += C[f, x]


def sum_over_corners(F: Faces, N: Vectors) -> Vectors:
    """Return at every vertex the sum, over the faces around it, of the vectors `N` (n, 3) at their corners (n, 3)."""
    total = np.zeros(N.shape)
    _add_over_corners(F, N, total)
    return total


@kernel()
def _add_over_corners(F: Faces, N: Vectors, total: Vectors) -> None:
    for f in range(F.shape[0]):
        i, j, k = F[f, 0], F[f, 1], F[f, 2]
        for x in range(3):
            around = N[i, x] + N[j, x] + N[k, x]
            total[i, x] += around
            total[j, x] += around
            total[k, x] += around


def mean_curvature_vectors(V: Vertices, F: Faces) -> Vectors:
    """Return the cotangent sums A_i H_i of Eq. 14 at every vertex (n, 3)."""
    L = np.zeros((len(V), 3))
    _add_mean_curvature(V, F, L)
    return L


@kernel()
def _add_mean_curvature(V: Vertices, F: Faces, L: Vectors) -> None:
    for f in range(F.shape[0]):
        i, j, k, _, _, _, double, di, dj, dk = corner(V, F, f)
        if double == 0.0:
            continue
        for x in range(3):
            # Half the cotangent at a corner times the edge opposite to it.
            at_i = 0.5 * di / double * (V[k, x] - V[j, x])
            at_j = 0.5 * dj / double * (V[i, x] - V[k, x])
            at_k = 0.5 * dk / double * (V[j, x] - V[i, x])
            L[i, x] += at_k - at_j
            L[j, x] += at_i - at_k
            L[k, x] += at_j - at_i


@kernel(inner=True)
def fold(V: Vertices, C: Vectors, u: int, v: int, f: int, g: int) -> tuple[float, float]:
    """Return length and signed exterior dihedral angle of the edge u-v, convex positive."""
    ex, ey, ez = V[v, 0] - V[u, 0], V[v, 1] - V[u, 1], V[v, 2] - V[u, 2]
    length = math.sqrt(ex * ex + ey * ey + ez * ez)
    if length == 0.0:
        return 0.0, 0.0
    ax, ay, az = C[f, 0], C[f, 1], C[f, 2]
    bx, by, bz = C[g, 0], C[g, 1], C[g, 2]
    sine = ((ay * bz - az * by) * ex + (az * bx - ax * bz) * ey + (ax * by - ay * bx) * ez) / length
    return length, math.atan2(sine, ax * bx + ay * by + az * bz)


@kernel()
def total_fold(V: Vertices, C: Vectors, E: Edges) -> float:
    """Return half the sum of length times exterior angle over the edges with two sides."""
    total = 0.0
    for e in range(E.shape[0]):
        if E[e, 3] >= 0:
            length, theta = fold(V, C, E[e, 0], E[e, 1], E[e, 2], E[e, 3])
            total += length * theta
    return 0.5 * total


@kernel()
def pyramids(V: Vertices, F: Faces, weight: PerFace) -> float:
    """Return the weighted sum of the pyramids of Eq. 16 over the faces, Eq. 19 where all weights are one.

    By Eq. 18 any corner of a face will do as the foot of its pyramid.
    """
    total = 0.0
    for f in range(F.shape[0]):
        i, _, _, cx, cy, cz, _, _, _, _ = corner(V, F, f)
        total += weight[f] * (V[i, 0] * cx + V[i, 1] * cy + V[i, 2] * cz)
    return total / 6.0


@kernel()
def add_pyramid_gradient(V: Vertices, F: Faces, weight: PerFace, out: Vectors) -> None:
    """Subtract the gradient of :func:`pyramids` from `out` (n, 3)."""
    for f in range(F.shape[0]):
        for c in range(3):
            i, j, k = F[f, c], F[f, (c + 1) % 3], F[f, (c + 2) % 3]
            w = weight[f] / 6.0
            out[i, 0] -= w * (V[j, 1] * V[k, 2] - V[j, 2] * V[k, 1])
            out[i, 1] -= w * (V[j, 2] * V[k, 0] - V[j, 0] * V[k, 2])
            out[i, 2] -= w * (V[j, 0] * V[k, 1] - V[j, 1] * V[k, 0])


@kernel()
def fold_gradient(V: Vertices, F: Faces, C: Vectors, E: Edges) -> Vectors:
    """Return the gradient of :func:`total_fold` (n, 3).

    Schlaefli: on a closed surface the angles' own variation sums to zero and only the
    lengths count. An open boundary edge is an edge of that closed surface whose other
    side stands still, so what its angle would have given is taken away again.
    """
    G = np.zeros((len(V), 3))
    for e in range(E.shape[0]):
        u, v, f, g = E[e, 0], E[e, 1], E[e, 2], E[e, 3]
        if g >= 0:
            length, theta = fold(V, C, u, v, f, g)
            if length > 0.0:
                for x in range(3):
                    pull = 0.5 * theta / length * (V[v, x] - V[u, x])
                    G[u, x] -= pull
                    G[v, x] += pull
            continue
        w = F[f, 0] + F[f, 1] + F[f, 2] - u - v
        square = C[f, 0] ** 2 + C[f, 1] ** 2 + C[f, 2] ** 2
        if square == 0.0:
            continue
        ee = 0.0
        ue = 0.0
        for x in range(3):
            ee += (V[v, x] - V[u, x]) ** 2
            ue += (V[v, x] - V[u, x]) * (V[w, x] - V[u, x])
        t = ue / ee
        for x in range(3):
            turn = 0.5 * ee * C[f, x] / square
            G[w, x] += turn
            G[u, x] -= turn * (1.0 - t)
            G[v, x] -= turn * t
    return G
