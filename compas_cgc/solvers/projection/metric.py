"""The fairness metric: how much a move of the vertices costs, in plan and in height."""

from __future__ import annotations

from functools import cached_property
from typing import Optional

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ...discrete import edge_faces
from ...discrete import face_areas
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...linalg import LinearSolver
from ...linalg import factorise

__all__ = ["Metric", "bending_matrix", "slope_jumps"]

# width of a sheet that bends as easily as a crease of stiffness 1/2 folds, over the distance of creases; a fold then costs the same on
# every mesh
WIDE = 0.15
SLENDER = 1e-3  # area of a hinge relative to the mean, which it has at least; slivers would be rigid otherwise


def bending_matrix(vertices: FloatArray, faces: IntArray, creases: NDArray[np.bool_], crease_stiffness: float) -> sparse.csr_matrix:
    r"""Return the bending energy of a move, per coordinate.

    Every hinge, an edge between two faces, costs :math:`3 (k \cdot u)^2 / (A_1 + A_2)`, where
    ``k . u`` is its length times the jump of u's slope across it. Linear moves cost
    nothing, and a free edge may turn freely, which the square of a cotangent Laplacian would
    not let it. What a bend costs depends on the layout of the mesh by a factor, of no
    consequence for a metric.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    creases
        ``(n,)`` vertices on creases; an edge between two of them is a crease.
    crease_stiffness
        Of creases, from 0, which fold freely, to 1, which are as stiff as the sheet beside them; between these a crease is a spring
        of the same stiffness per length on every mesh.

    Returns
    -------
    csr_matrix
        ``(n, n)`` symmetric, positive semidefinite [1/L^2].

    References
    ----------
    Bergou, Wardetzky, Harmon, Zorin, Grinspun, *A quadratic bending model for inextensible
    surfaces*, SGP 2006, doi:10.2312/SGP/SGP06/227-230.
    """
    edges = edge_faces(faces)
    u, v, left, right = edges[edges[:, 3] >= 0].T
    ends = u + v
    p, q = faces[left].sum(axis=1) - ends, faces[right].sum(axis=1) - ends
    along = vertices[v] - vertices[u]
    double_p, cot_up, cot_vp = _cotangents(vertices, along, u, v, p)
    double_q, cot_uq, cot_vq = _cotangents(vertices, along, u, v, q)
    area = 0.5 * (double_p + double_q)
    area = np.maximum(area, SLENDER * area.mean()) if len(area) else area
    # A spring along the crease, one behind the other with the sheet beside it: so a fold costs the same on every mesh.
    crease = creases[u] & creases[v]
    lengths, total = np.linalg.norm(along[crease], axis=1), face_areas(vertices, faces).sum()
    across, wide = crease_stiffness * area[crease] / lengths, WIDE * total / (np.sqrt(total) + lengths.sum())
    stiffness = np.ones(len(u))
    stiffness[crease] = across / (across + (1.0 - crease_stiffness) * wide)
    weight = np.sqrt(3.0 * stiffness / area)
    values = weight * np.array([cot_vp + cot_vq, cot_up + cot_uq, -(cot_up + cot_vp), -(cot_uq + cot_vq)])
    rows = np.tile(np.arange(len(u)), 4)
    jumps = sparse.csr_matrix((values.ravel(), (rows, np.concatenate([u, v, p, q]))), shape=(len(u), len(vertices)))
    return (jumps.T @ jumps).tocsr()


def slope_jumps(vertices: FloatArray, faces: IntArray, hinges: IntArray) -> tuple[IntArray, sparse.csr_matrix]:
    """Return edges (h, 2), and the matrix (h, n) of the changes of the angles across them by moves along the normals, to first order.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    hinges
        ``(h,)`` positions among the edges with two faces.

    References
    ----------
    Bergou, Wardetzky, Harmon, Zorin, Grinspun, doi:10.2312/SGP/SGP06/227-230.
    """
    edges = edge_faces(faces)
    u, v, left, right = edges[edges[:, 3] >= 0][hinges].T
    p, q = faces[left].sum(axis=1) - u - v, faces[right].sum(axis=1) - u - v
    along = vertices[v] - vertices[u]
    _, cot_up, cot_vp = _cotangents(vertices, along, u, v, p)
    _, cot_uq, cot_vq = _cotangents(vertices, along, u, v, q)
    values = np.array([cot_vp + cot_vq, cot_up + cot_uq, -(cot_up + cot_vp), -(cot_uq + cot_vq)]) / np.linalg.norm(along, axis=1)
    rows = np.tile(np.arange(len(u)), 4)
    matrix = sparse.csr_matrix((values.ravel(), (rows, np.concatenate([u, v, p, q]))), shape=(len(u), len(vertices)))
    return np.column_stack([u, v]), matrix


def _cotangents(vertices: FloatArray, along: FloatArray, u: IntArray, v: IntArray, apex: IntArray) -> tuple[FloatArray, ...]:
    """Return twice the area of the faces u-v-apex and the cotangents of their angles at u and v."""
    side = vertices[apex] - vertices[u]
    double = np.linalg.norm(np.cross(along, side), axis=1)
    safe = np.maximum(double, SLENDER * double.mean()) if len(double) else double
    dot = np.einsum("ij,ij->i", along, side)
    square = np.einsum("ij,ij->i", along, along)
    return double, dot / safe, (square - dot) / safe


class Metric:
    """The cost ½ dxᵀ W dx of a move in the directions that constraints leave free.

    Parameters
    ----------
    plan, height
        ``(c, c)`` W of one coordinate in plan, and of the height; symmetric and positive definite.
        The same matrix twice where no direction is up.
    axes
        ``(3, 3)`` orthonormal rows: two directions in plan, and up.
    points
        ``(q, 3)`` places of the free directions, for the order of elimination.
    basis
        ``(3c, q)`` free directions in the columns, or ``None`` where all are free.
    """

    def __init__(
        self,
        plan: sparse.csr_matrix,
        height: sparse.csr_matrix,
        axes: FloatArray,
        points: FloatArray,
        basis: Optional[sparse.csr_matrix] = None,
    ):
        self.plan, self.height, self.axes, self.points, self.basis = plan, height, axes, points, basis

    # Without refinement: the solves are the greater part of the work, and any fixed matrix near to the inverse serves.
    @cached_property
    def _factor(self) -> LinearSolver:
        if self.basis is None:
            return factorise(self.plan, symmetric=True, points=self.points[::3], refine=False)
        return factorise(self._on_span(self.basis), symmetric=True, points=self.points, refine=False)

    @cached_property
    def _of_height(self) -> LinearSolver:
        if self.height is self.plan:
            return self._factor
        return factorise(self.height, symmetric=True, points=self.points[::3], refine=False)

    def solve(self, gradient: FloatArray) -> FloatArray:
        """Return the move (q,) whose metric product with any other is that of the gradient (q,)."""
        if self.basis is not None:
            return self._factor.solve(gradient)
        if self.height is self.plan:
            return self._factor.solve(gradient.reshape(-1, 3)).ravel()
        turned = gradient.reshape(-1, 3) @ self.axes.T
        found = np.empty_like(turned)
        found[:, :2], found[:, 2] = self._factor.solve(turned[:, :2]), self.heights(gradient)
        return (found @ self.axes).ravel()

    def heights(self, gradient: FloatArray) -> FloatArray:
        """Return the heights (c,) of the move for a gradient (3c,) where all directions are free."""
        return self._of_height.solve(gradient.reshape(-1, 3) @ self.axes[2])

    def times(self, move: FloatArray) -> FloatArray:
        """Return W times a move (q,)."""
        if self.basis is None:
            return self._times(move)
        return self.basis.T @ self._times(self.basis @ move)

    def fairest(self, move: FloatArray) -> FloatArray:
        """Return the cheapest of all moves that differ from one (3c,) by free directions only."""
        if self.basis is None:
            return np.zeros_like(move)
        return move - self.basis @ self.solve(self.basis.T @ self._times(move))

    def reduced(self, directions: sparse.csr_matrix) -> sparse.csr_matrix:
        """Return W on the span of the columns of `directions` (q, p)."""
        return self._on_span(directions if self.basis is None else self.basis @ directions)

    def _times(self, move: FloatArray) -> FloatArray:
        turned = move.reshape(-1, 3) @ self.axes.T
        flat, up = self.plan @ turned[:, :2], self.height @ turned[:, 2]
        return (flat @ self.axes[:2] + up[:, None] * self.axes[2]).ravel()

    def _on_span(self, directions: sparse.csr_matrix) -> sparse.csr_matrix:
        directions = directions.tocsr()
        coordinates = [directions[x::3] for x in range(3)]
        if self.height is self.plan:
            return _total([part.T @ self.plan @ part for part in coordinates])
        along = [_total([axis[x] * coordinates[x] for x in range(3)]) for axis in self.axes]
        weights = (self.plan, self.plan, self.height)
        return _total([part.T @ weight @ part for part, weight in zip(along, weights)])


def _total(matrices: list[sparse.csr_matrix]) -> sparse.csr_matrix:
    first, second, third = matrices
    return (first + second + third).tocsr()
