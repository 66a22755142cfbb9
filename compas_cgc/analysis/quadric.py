"""Curvatures by a local quadric fit: a second measure beside the angle defect."""

from __future__ import annotations

import math
from typing import NamedTuple
from typing import Optional

import numpy as np
from numba import njit
from numpy.typing import ArrayLike
from scipy import sparse

from ..discrete import mesh_arrays
from ..discrete import vertex_normals
from ..discrete.arrays import FloatArray

__all__ = ["QuadricCurvatures", "quadric_curvatures"]


class QuadricCurvatures(NamedTuple):
    """Curvatures of fitted quadrics, NaN where no fit was made."""

    gaussian: FloatArray  # (n,) [1/L^2]
    mean: FloatArray  # (n,) positive where convex towards the normal [1/L]
    largest: FloatArray  # (n,) larger principal curvature [1/L]
    smallest: FloatArray  # (n,) smaller principal curvature [1/L]


@njit(cache=True)
def fit(V, N, start, near, through, wanted):
    """Return K and H (n, 2) of the quadric through each wanted vertex that is nearest to its two rings.

    The second ring is reached through vertices of `through` only, so that a fit does
    not look across a crease.
    """
    out = np.full((V.shape[0], 2), np.nan)
    ring = np.empty(512, np.int64)
    for i in range(V.shape[0]):
        if not wanted[i]:
            continue
        count = 0
        for a in range(start[i], start[i + 1]):
            ring[count] = near[a]
            count += 1
        first = count
        for b in range(first):
            if through[ring[b]]:
                for a in range(start[ring[b]], start[ring[b] + 1]):
                    j = near[a]
                    known = j == i or count >= 512
                    for c in range(count):
                        known = known or ring[c] == j
                    if not known:
                        ring[count] = j
                        count += 1
        if count < 5:
            continue
        # A frame with the normal as its third axis.
        n = N[i]
        axis = np.zeros(3)
        axis[np.argmin(np.abs(n))] = 1.0
        x = np.cross(n, axis)
        length = math.sqrt(x @ x)
        if length == 0.0:
            continue
        x /= length
        y = np.cross(n, x)
        scale = 0.0
        for c in range(first):
            d = V[ring[c]] - V[i]
            scale = max(scale, math.sqrt(d @ d))
        M = np.zeros((5, 5))
        r = np.zeros(5)
        row = np.empty(5)
        for c in range(count):
            d = (V[ring[c]] - V[i]) / scale
            u, v, w = d @ x, d @ y, d @ n
            row[0], row[1], row[2], row[3], row[4] = u, v, 0.5 * u * u, u * v, 0.5 * v * v
            weight = 1.0 / (u * u + v * v + 1e-3)
            for k in range(5):
                r[k] += weight * row[k] * w
                for m in range(5):
                    M[k, m] += weight * row[k] * row[m]
        trace = 0.0
        for k in range(5):
            trace += M[k, k]
        for k in range(5):
            # Rings on a conic do not determine a quadric; this picks the flattest.
            M[k, k] += 1e-14 * trace
        p, q, uu, uv, vv = np.linalg.solve(M, r)
        g = 1.0 + p * p + q * q
        out[i, 0] = (uu * vv - uv * uv) / (g * g) / (scale * scale)
        out[i, 1] = -((1 + q * q) * uu - 2 * p * q * uv + (1 + p * p) * vv) / (2 * g * math.sqrt(g)) / scale
    return out


def quadric_curvatures(
    vertices: ArrayLike, faces: ArrayLike, wanted: Optional[ArrayLike] = None, through: Optional[ArrayLike] = None
) -> QuadricCurvatures:
    """Fit a quadric to the two rings around vertices and return its curvatures.

    On meshes of any valence these converge to the curvatures of a smooth surface, which
    the angle defect does only at vertices of valence 6 or 4; in exchange they are not
    exact for the polyhedron at hand.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, anticlockwise seen from outside.
    wanted
        ``(n,)`` bool: where to fit. Default: everywhere.
    through
        ``(n,)`` bool: vertices that the second ring may be reached through. Default: all.

    Returns
    -------
    QuadricCurvatures

    References
    ----------
    Cazals and Pouget, doi:10.1016/j.cagd.2004.09.004.
    """
    V, F = mesh_arrays(vertices, faces)
    n = len(V)
    u, v = F.ravel(), np.roll(F, -1, axis=1).ravel()
    ones = np.ones(2 * len(u))
    graph = sparse.csr_matrix((ones, (np.r_[u, v], np.r_[v, u])), shape=(n, n))
    graph.sort_indices()
    everywhere = np.ones(n, bool)
    wanted = everywhere if wanted is None else np.asarray(wanted, dtype=bool)
    through = everywhere if through is None else np.asarray(through, dtype=bool)
    K, H = fit(V, vertex_normals(V, F), graph.indptr.astype(np.int64), graph.indices.astype(np.int64), through, wanted).T
    spread = np.sqrt(np.maximum(H * H - K, 0.0))
    return QuadricCurvatures(K, H, H + spread, H - spread)
