"""Curvatures of quadrics fitted by local least squares, a second measure besides the angle defect."""

from __future__ import annotations

import math
from typing import NamedTuple
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from .._compiled import kernel
from ..discrete import mesh_arrays
from ..discrete import vertex_normals
from ..discrete._cholesky import solve_in_place
from ..discrete._memo import remembered
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Indices
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.arrays import PerVertex
from ..discrete.arrays import Vectors
from ..discrete.arrays import Vertices
from ..errors import names_what_was_meant

__all__ = ["QuadricCurvatures", "quadric_curvatures"]

REGULARISATION = 1e-14  # added to the diagonal, relative to the trace; points on a conic do not determine a quadric


class QuadricCurvatures(NamedTuple):
    """Curvatures of fitted quadrics, NaN without a fit."""

    gaussian: PerVertex  # (n,) [1/L^2]
    mean: PerVertex  # (n,) positive if convex towards the normal [1/L]
    largest: PerVertex  # (n,) larger principal curvature [1/L]
    smallest: PerVertex  # (n,) smaller principal curvature [1/L]


@kernel()
def across(n0: float, n1: float, n2: float) -> tuple[float, float, float]:
    """Return the cross product of a vector with the coordinate axis of its smallest component."""
    a0, a1, a2 = abs(n0), abs(n1), abs(n2)
    if a0 <= a1 and a0 <= a2:
        return 0.0, n2, -n1
    if a1 <= a2:
        return -n2, 0.0, n0
    return n1, -n0, 0.0


@kernel()
def fit(V: Vertices, N: Vectors, start: Indices, near: Indices, through: Mask, wanted: Mask) -> FloatArray:
    """Return K and H (n, 2) of the least-squares quadric through each wanted vertex, fitted to its two rings.

    The second ring is collected through vertices of `through` only, so that fits do not
    reach across creases.
    """
    out = np.full((V.shape[0], 2), np.nan)
    ring = np.empty(512, np.int64)
    M, r, row = np.empty((5, 5)), np.empty(5), np.empty(5)
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
        # Local frame with the normal as third axis.
        n0, n1, n2 = N[i]
        x0, x1, x2 = across(n0, n1, n2)
        length = math.sqrt(x0 * x0 + x1 * x1 + x2 * x2)
        if length == 0.0:
            continue
        x0, x1, x2 = x0 / length, x1 / length, x2 / length
        y0, y1, y2 = n1 * x2 - n2 * x1, n2 * x0 - n0 * x2, n0 * x1 - n1 * x0
        scale = 0.0
        for c in range(first):
            j = ring[c]
            d0, d1, d2 = V[j, 0] - V[i, 0], V[j, 1] - V[i, 1], V[j, 2] - V[i, 2]
            scale = max(scale, d0 * d0 + d1 * d1 + d2 * d2)
        scale = math.sqrt(scale)
        M[:] = 0.0
        r[:] = 0.0
        for c in range(count):
            j = ring[c]
            d0, d1, d2 = (V[j, 0] - V[i, 0]) / scale, (V[j, 1] - V[i, 1]) / scale, (V[j, 2] - V[i, 2]) / scale
            u, v, w = d0 * x0 + d1 * x1 + d2 * x2, d0 * y0 + d1 * y1 + d2 * y2, d0 * n0 + d1 * n1 + d2 * n2
            row[0], row[1], row[2], row[3], row[4] = u, v, 0.5 * u * u, u * v, 0.5 * v * v
            weight = 1.0 / (u * u + v * v + 1e-3)
            for k in range(5):
                r[k] += weight * row[k] * w
                for m in range(k + 1):
                    M[k, m] += weight * row[k] * row[m]
        solve_in_place(M, r, len(r), REGULARISATION)
        p, q, uu, uv, vv = r
        g = 1.0 + p * p + q * q
        out[i, 0] = (uu * vv - uv * uv) / (g * g) / (scale * scale)
        out[i, 1] = -((1 + q * q) * uu - 2 * p * q * uv + (1 + p * p) * vv) / (2 * g * math.sqrt(g)) / scale
    return out


@remembered
def _neighbours(F: Faces, n: int) -> tuple[IntArray, IntArray]:
    """Return the offsets (n + 1,) and the sorted neighbours of all vertices."""
    u, v = F.ravel(), np.roll(F, -1, axis=1).ravel()
    graph = sparse.csr_matrix((np.ones(2 * len(u)), (np.r_[u, v], np.r_[v, u])), shape=(n, n))
    graph.sort_indices()
    return graph.indptr.astype(np.int64), graph.indices.astype(np.int64)


@names_what_was_meant()
def quadric_curvatures(
    vertices: ArrayLike, faces: ArrayLike, wanted: Optional[ArrayLike] = None, through: Optional[ArrayLike] = None
) -> QuadricCurvatures:
    """Return the curvatures of quadrics fitted to the two rings around vertices.

    They converge to the curvatures of a smooth surface at any valence, while the angle defect
    does so only at vertices of valence 6 or 4. Unlike the angle defect they are not an exact
    property of the polyhedron.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside.
    wanted
        ``(n,)`` bool: vertices to fit at. Default: all.
    through
        ``(n,)`` bool: vertices through which the second ring is collected. Default: all.

    Returns
    -------
    QuadricCurvatures

    References
    ----------
    Cazals and Pouget, doi:10.1016/j.cagd.2004.09.004.

    Examples
    --------
    >>> import compas_cgc
    >>> vertices, faces = compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))).mesh.arrays()
    >>> found = quadric_curvatures(vertices, faces)
    >>> len(found.gaussian) == len(vertices)
    True
    """
    V, F = mesh_arrays(vertices, faces)
    everywhere = np.ones(len(V), bool)
    where = everywhere if wanted is None else np.asarray(wanted, dtype=bool)
    reached = everywhere if through is None else np.asarray(through, dtype=bool)
    K, H = fit(V, vertex_normals(V, F), *_neighbours(F, len(V)), reached, where).T
    spread = np.sqrt(np.maximum(H * H - K, 0.0))
    return QuadricCurvatures(K, H, H + spread, H - spread)
