"""NURBS surfaces fitted to regions: cubic tensor-product splines, their distance from the mesh and the K of the splines themselves."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse
from scipy.interpolate import BSpline
from scipy.sparse.linalg import spsolve

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import MeshError
from ..meshing import boundary_loops

__all__ = ["FittedSurface", "fit_surface"]

DEGREE = 3
FREE = 6  # control points along a side at which vertices are met one by one
PER_EDGE = 0.5  # further ones for each edge along it
MOST = 24  # control points along a side
STIFF = 1e-9  # weight of the bending of the spline against that of the points
CORRECTIONS = 6  # rounds in which the points' parameters follow the surface
SAMPLES = 12  # places along a side at which K is read off the spline


class FittedSurface(NamedTuple):
    """A cubic spline surface, not rational."""

    control: FloatArray  # (a, b, 3) control points [L]
    knots_u: FloatArray  # (a + 4,) with the ends four times
    knots_v: FloatArray  # (b + 4,)
    deviation: float  # largest distance of a vertex of the mesh from it [L]
    gaussian: FloatArray  # (k,) K of the surface itself at places within the region [1/L^2]


def fit_surface(vertices: FloatArray, faces: IntArray, size: Optional[tuple[int, int]] = None) -> FittedSurface:
    """Fit a spline surface to a region of a mesh that has one boundary loop.

    The boundary is laid out on the sides of a square by its four sharpest corners and the rest by a harmonic map; a smoothing
    spline is fitted, and the parameters of the points are moved to their closest points on it, over and over.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` triangles of the region.
    size
        Control points in both directions. Default: by the vertices along the sides.

    Raises
    ------
    MeshError
        If the region is no disc.

    References
    ----------
    Hoschek, doi:10.1016/0167-8396(88)90005-2.
    """
    used, local = np.unique(faces, return_inverse=True)
    V, F = vertices[used], local.reshape(faces.shape)
    loops = boundary_loops(F)
    edges = np.unique(np.sort(np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1), axis=0)
    if len(loops) != 1 or len(V) - len(edges) + len(F) != 1:
        raise MeshError("a region with holes, or a closed one, has no four sides; cut it by a crease to fit a NURBS surface")
    centre = V.mean(axis=0)
    scale = float(np.linalg.norm(np.ptp(V, axis=0)))
    P = (V - centre) / scale
    uv, sides = _square(P, F, np.asarray(loops[0]))
    a, b = size or (_count(own) for own in sides)
    knots = _knots(a), _knots(b)
    loop = np.asarray(loops[0])
    control = _fitted(P, uv, knots, (a, b))
    for _ in range(CORRECTIONS):
        uv = _closest(P, uv, control, knots, loop)
        control = _fitted(P, uv, knots, (a, b))
    gap = np.linalg.norm(_at(control, knots, uv) - P, axis=1).max()
    return FittedSurface(control * scale + centre, *knots, float(gap) * scale, _gaussian(control, knots) / scale**2)


def _count(edges: float) -> int:
    """Return how many control points a side of so many edges gets."""
    return int(np.clip(round(min(edges + 1, FREE + PER_EDGE * max(0.0, edges + 1 - FREE))), DEGREE + 1, MOST))


def _square(P: FloatArray, F: IntArray, loop: IntArray) -> tuple[FloatArray, tuple[float, float]]:
    """Return parameters (n, 2) in the unit square, and the mean numbers of vertices along its two pairs of sides."""
    rim = P[loop]
    ahead, behind = np.roll(rim, -1, axis=0) - rim, rim - np.roll(rim, 1, axis=0)
    turn = np.arctan2(np.linalg.norm(np.cross(behind, ahead), axis=1), np.einsum("ij,ij->i", behind, ahead))
    corners: list[int] = []
    for k in np.argsort(-turn, kind="stable").tolist():
        if all(min(abs(k - other), len(loop) - abs(k - other)) >= max(2, len(loop) // 12) for other in corners):
            corners.append(k)
        if len(corners) == 4:
            break
    if len(corners) < 4:
        raise MeshError("a region with so few vertices on its boundary cannot be fitted; refine the mesh")
    order = np.roll(np.arange(len(loop)), -min(corners))
    starts = sorted((k - min(corners)) % len(loop) for k in corners)
    length = np.linalg.norm(np.roll(rim[order], -1, axis=0) - rim[order], axis=1)
    at = np.concatenate([[0.0], np.cumsum(length)])
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]], dtype=np.float64)
    ends = [*starts, len(loop)]
    fixed = np.empty((len(loop), 2))
    for k in range(4):
        own = np.arange(ends[k], ends[k + 1])
        t = (at[own] - at[ends[k]]) / (at[ends[k + 1]] - at[ends[k]])
        fixed[own] = square[k] + t[:, None] * (square[k + 1] - square[k])
    uv = np.zeros((len(P), 2))
    uv[loop[order]] = fixed
    counts = np.diff(ends)
    return _harmonic(P, F, uv, loop), (0.5 * (counts[0] + counts[2]), 0.5 * (counts[1] + counts[3]))


def _harmonic(P: FloatArray, F: IntArray, uv: FloatArray, loop: IntArray) -> FloatArray:
    """Return parameters whose inner ones are means of their neighbours', weighted by nearness (n, 2)."""
    n = len(P)
    u, v = F.ravel(), np.roll(F, -1, axis=1).ravel()
    weight = 1.0 / np.linalg.norm(P[u] - P[v], axis=1)
    graph = sparse.csr_matrix((np.r_[weight, weight], (np.r_[u, v], np.r_[v, u])), shape=(n, n))
    free = np.setdiff1d(np.arange(n), loop)
    if not len(free):
        return uv
    laplacian = sparse.diags(np.asarray(graph.sum(axis=1)).ravel()) - graph
    result = uv.copy()
    result[free] = np.reshape(spsolve(laplacian[free][:, free].tocsc(), -(laplacian[free] @ uv)), (-1, 2))
    return result


def _knots(count: int) -> FloatArray:
    inner = np.linspace(0.0, 1.0, count - DEGREE + 1)
    return np.concatenate([np.zeros(DEGREE), inner, np.ones(DEGREE)])


Knots = tuple[FloatArray, FloatArray]


def _basis(uv: FloatArray, knots: Knots, order: tuple[int, int] = (0, 0)) -> sparse.csr_matrix:
    """Return the values, or derivatives of an order in each direction, of all products of basis functions (k, a b)."""
    parts = []
    for axis in range(2):
        count = len(knots[axis]) - DEGREE - 1
        basis = BSpline(knots[axis], np.eye(count), DEGREE)
        parts.append((basis.derivative(order[axis]) if order[axis] else basis)(np.clip(uv[:, axis], 0.0, 1.0)))
    return sparse.csr_matrix((parts[0][:, :, None] * parts[1][:, None, :]).reshape(len(uv), -1))


def _fitted(P: FloatArray, uv: FloatArray, knots: Knots, shape: tuple[int, int]) -> FloatArray:
    """Return the control points (a, b, 3) of the smoothing spline."""
    B = _basis(uv, knots)
    t = (np.arange(2 * max(shape)) + 0.5) / (2 * max(shape))
    grid = np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1).reshape(-1, 2)
    bending = sum(
        factor * (D.T @ D)
        for factor, D in ((1.0, _basis(grid, knots, (2, 0))), (2.0, _basis(grid, knots, (1, 1))), (1.0, _basis(grid, knots, (0, 2))))
    )
    normal = B.T @ B / len(P) + STIFF * bending / len(grid)
    return np.reshape(spsolve(normal.tocsc(), B.T @ P / len(P)), (*shape, 3))


def _at(control: FloatArray, knots: Knots, uv: FloatArray, order: tuple[int, int] = (0, 0)) -> FloatArray:
    return _basis(uv, knots, order) @ control.reshape(-1, 3)


def _closest(P: FloatArray, uv: FloatArray, control: FloatArray, knots: Knots, loop: IntArray) -> FloatArray:
    """Return parameters (n, 2) moved to the closest points; those on the boundary stay on their side."""
    off = P - _at(control, knots, uv)
    a, b = _at(control, knots, uv, (1, 0)), _at(control, knots, uv, (0, 1))
    aa, ab, bb = ((x * y).sum(axis=1) for x, y in ((a, a), (a, b), (b, b)))
    p, q = (a * off).sum(axis=1), (b * off).sum(axis=1)
    det = np.maximum(aa * bb - ab * ab, 1e-300)
    move = np.column_stack([bb * p - ab * q, aa * q - ab * p]) / det[:, None]
    held = np.zeros((len(P), 2), bool)
    held[loop] = (uv[loop] <= 0.0) | (uv[loop] >= 1.0)
    inner = np.clip(uv + np.where(held, 0.0, np.clip(move, -0.05, 0.05)), 1e-9, 1.0 - 1e-9)
    return np.where(held, uv, inner)


def _gaussian(control: FloatArray, knots: Knots) -> FloatArray:
    """Return K of the surface at places within its square (k,)."""
    t = (np.arange(SAMPLES) + 0.5) / SAMPLES
    uv = np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1).reshape(-1, 2)
    u, v, uu, uw, ww = (_at(control, knots, uv, order) for order in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2)))
    normal = np.cross(u, v)
    square = (normal**2).sum(axis=1)
    e, f, g = ((second * normal).sum(axis=1) for second in (uu, uw, ww))
    return (e * g - f * f) / square**2
