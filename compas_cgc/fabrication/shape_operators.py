"""Shape operators of polynomials fitted around vertices, with principal curvatures and directions."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .._compiled import kernel
from ..discrete import boundary_vertices
from ..discrete import mesh_arrays
from ..discrete import vertex_normals
from ..discrete._cholesky import solve_in_place
from ..discrete._least_squares import CENTRED
from ..discrete._local_fits import MIN_OVERSAMPLING
from ..discrete._local_fits import TERMS
from ..discrete._rings import MOST
from ..discrete._rings import around
from ..discrete._rings import gather
from ..discrete._rings import monomials
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import PerVertex
from ..discrete.arrays import Vectors
from ..discrete.arrays import Vertices

__all__ = ["PrincipalCurvatures", "ShapeOperators", "principal_curvatures", "shape_operators"]

DEGREE, RINGS = 4, 3


class PrincipalCurvatures(NamedTuple):
    """Principal curvatures, positive if convex towards the normal."""

    larger: PerVertex  # (n,) [1/L]
    smaller: PerVertex  # (n,) [1/L]
    larger_direction: Vectors  # (n, 3) unit
    smaller_direction: Vectors  # (n, 3) unit


class ShapeOperators(NamedTuple):
    """Second fundamental forms as matrices in space."""

    operators: FloatArray  # (n, 3, 3) S with S n = 0, positive if convex towards n [1/L]
    normals: Vectors  # (n, 3) unit normals n of the fits


def shape_operators(vertices: ArrayLike, faces: ArrayLike, degree: int = DEGREE) -> ShapeOperators:
    """Return the shape operator at every vertex as a symmetric matrix in space.

    A polynomial height over the tangent plane is fitted to three rings around a vertex (four at the boundary).

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside; give the faces of one region, so that fits do not
        reach across creases.
    degree
        Degree of the polynomials, 2 to 4; reduced if the rings have too few vertices.

    Returns
    -------
    ShapeOperators
        NaN at vertices with too few neighbours.

    References
    ----------
    Cazals and Pouget, doi:10.1016/j.cagd.2004.09.004.
    """
    V, F = mesh_arrays(vertices, faces)
    start, near = around(F, len(V))
    rings = np.where(boundary_vertices(V, F), RINGS + 1, RINGS)
    found = _fitted(V, vertex_normals(V, F), F, start, near, rings, degree)
    return ShapeOperators(found[:, :3], found[:, 3])


def principal_curvatures(operators: FloatArray, normals: Vectors) -> PrincipalCurvatures:
    """Return the principal curvatures and directions of shape operators (n, 3, 3), of surfaces with normals (n, 3)."""
    known = np.isfinite(operators).all(axis=(1, 2))
    # Shift the eigenvalue of the normal above the others.
    scale = 4.0 * np.abs(operators[known]).max(initial=1.0)
    lifted = operators[known] + scale * normals[known, :, None] * normals[known, None, :]
    values, vectors = np.linalg.eigh(lifted)
    result = [np.full(len(operators), np.nan) for _ in range(2)] + [np.full((len(operators), 3), np.nan) for _ in range(2)]
    for k, found in enumerate((values[:, 1], values[:, 0], vectors[:, :, 1], vectors[:, :, 0])):
        result[k][known] = found
    return PrincipalCurvatures(*result)


@kernel()
def _fitted(V: Vertices, N: Vectors, F: Faces, start: IntArray, near: IntArray, rings: IntArray, degree: int) -> FloatArray:
    n = V.shape[0]
    out = np.full((n, 4, 3), np.nan)
    ring, stamp = np.empty(MOST, np.int64), np.full(n, -1)
    through = np.ones(n, np.bool_)
    most = TERMS[degree]
    M, r, row = np.empty((most, most)), np.empty(most), np.empty(most)
    J, I, II = np.empty((3, 2)), np.empty((2, 2)), np.empty((2, 2))
    for i in range(n):
        if start[i] == start[i + 1]:
            continue
        count = gather(i, F, start, near, through, rings[i], ring, stamp)
        used = degree
        while used > 2 and count < MIN_OVERSAMPLING * TERMS[used]:
            used -= 1
        terms = TERMS[used]
        n0, n1, n2 = N[i]
        if count < terms or n0 * n0 + n1 * n1 + n2 * n2 == 0.0:
            continue
        x0, x1, x2 = 0.0, n2, -n1
        if abs(n0) > abs(n1) or abs(n0) > abs(n2):
            x0, x1, x2 = (-n2, 0.0, n0) if abs(n1) <= abs(n2) else (n1, -n0, 0.0)
        length = math.sqrt(x0 * x0 + x1 * x1 + x2 * x2)
        x0, x1, x2 = x0 / length, x1 / length, x2 / length
        y0, y1, y2 = n1 * x2 - n2 * x1, n2 * x0 - n0 * x2, n0 * x1 - n1 * x0
        scale = 0.0
        for c in range(count):
            d0, d1, d2 = V[ring[c], 0] - V[i, 0], V[ring[c], 1] - V[i, 1], V[ring[c], 2] - V[i, 2]
            scale = max(scale, d0 * d0 + d1 * d1 + d2 * d2)
        scale = math.sqrt(scale)
        if scale == 0.0:
            continue
        M[:] = 0.0
        r[:] = 0.0
        for c in range(count):
            d0, d1, d2 = V[ring[c], 0] - V[i, 0], V[ring[c], 1] - V[i, 1], V[ring[c], 2] - V[i, 2]
            u, v = (d0 * x0 + d1 * x1 + d2 * x2) / scale, (d0 * y0 + d1 * y1 + d2 * y2) / scale
            w = (d0 * n0 + d1 * n1 + d2 * n2) / scale
            monomials(u, v, used, row)
            weight = 1.0 / (u * u + v * v + CENTRED)
            for k in range(terms):
                r[k] += weight * row[k] * w
                for m in range(k + 1):
                    M[k, m] += weight * row[k] * row[m]
        solve_in_place(M, r, terms, 0.0)
        a, b = r[0], r[1]
        g = math.sqrt(1.0 + a * a + b * b)
        # Fundamental forms of the graph, the second with the sign of convexity.
        I[0, 0], I[0, 1], I[1, 0], I[1, 1] = 1.0 + a * a, a * b, a * b, 1.0 + b * b
        II[0, 0], II[0, 1], II[1, 0], II[1, 1] = 2.0 * r[2], r[3], r[3], 2.0 * r[4]
        inverse = np.linalg.inv(I)
        J[0, 0], J[1, 0], J[2, 0] = x0 + a * n0, x1 + a * n1, x2 + a * n2
        J[0, 1], J[1, 1], J[2, 1] = y0 + b * n0, y1 + b * n1, y2 + b * n2
        out[i, :3] = -(J @ inverse @ II @ inverse @ J.T) / (g * scale)
        out[i, 3, 0], out[i, 3, 1], out[i, 3, 2] = (n0 - a * x0 - b * y0) / g, (n1 - a * x1 - b * y1) / g, (n2 - a * x2 - b * y2) / g
    return out
