"""What is fair: a shape that bends little, and keeps to the drawing as far as the designer wants."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Optional

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ...discrete import face_normals
from ...discrete import vertex_areas
from ...discrete import vertex_normals
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...model.constraints import Constraint
from ...model.constraints import Proximity
from ...model.constraints import indices
from ...model.problem import CGCProblem
from ...model.roles import CREASE
from ..constants import FACING
from ..constants import SHAPE_KEPT
from ..constants import SMALLEST_FACE
from .metric import Metric
from .metric import bending_matrix
from .placement import Freedoms
from .settings import KEEP
from .settings import ProjectionSettings
from .vectors import dot

__all__ = ["Fairness", "flat_share"]

FLAT = 1e-15  # squared height in the local frame at rounding level [L²]; the square of 3e-8, below any drawn shape
FLAT_FOLD = 0.01  # fold relative to that of the target, below which a place is flat; half and twice it give the same surfaces


class Fairness:
    """The energy of a problem's shapes, and its metric for every set of free directions.

    ``E(x) = ½ (smoothness sqrt(A))^4 xᵀ Q x + ½ nearness |x - x₀|²``, with Q the bending energy, A the
    area of the mesh and x₀ the drawing; the distance is weighed by areas, and apart in plan and height.
    What is bent is the shape, so E does not depend on the way that led to it; of a drawing whose shape is kept, the move.

    Parameters
    ----------
    problem
        The problem in its local frame.
    faces
        ``(m, 3)`` its real faces.
    columns
        ``(c,)`` vertices that may move.
    size
        Square root of the area.
    settings
        Parameters.
    constraints
        Of which those that weigh vertices are taken.
    """

    def __init__(
        self,
        problem: CGCProblem,
        faces: IntArray,
        columns: IntArray,
        size: float,
        settings: ProjectionSettings,
        constraints: Sequence[Constraint],
    ):
        V = problem.vertices
        mass = vertex_areas(V, faces)
        mass = np.maximum(mass, SMALLEST_FACE * mass.mean())
        bending = size**4 * bending_matrix(V, faces, problem.roles == CREASE, settings.crease_stiffness)
        weights = np.full(len(V), settings.nearness)
        for constraint in constraints:
            if isinstance(constraint, Proximity):
                weights[indices(constraint.vertices, len(V))] *= constraint.weight
        self.axes, has_plan = _axes(V, faces)
        self._has_plan = has_plan
        plan, height = KEEP[settings.keep]
        pull = (weights * mass)[columns]
        self._pull = np.column_stack([plan * pull, plan * pull, (height if has_plan else plan) * pull])
        self._columns, self._drawing = columns, V
        self.points = np.repeat(V[columns], 3, axis=0)
        # Of a shape that is kept only the move is bent: one that has the curvature already stays as it is.
        self._unbent = V if settings.keep == "shape" else np.zeros_like(V)
        self._bending = (settings.smoothness**4 * bending).tocsr()
        own = self._bending[columns][:, columns]
        self.plan = (own + sparse.diags(self._pull[:, 0])).tocsr()
        self.height = (own + sparse.diags(self._pull[:, 2])).tocsr() if has_plan else self.plan
        self._last: Optional[Metric] = None
        self._second: Optional[sparse.csr_matrix] = None

    @property
    def rest(self) -> FloatArray:
        """The drawing (n, 3), as it counts."""
        return self._drawing

    @property
    def plan_axes(self) -> Optional[FloatArray]:
        """Two directions (2, 3) in plan, None without a plan."""
        return self.axes[:2] if self._has_plan else None

    @property
    def bending(self) -> sparse.csr_matrix:
        """The bending energy of a coordinate (n, n)."""
        return self._bending

    def energy(self, vertices: FloatArray) -> tuple[float, FloatArray]:
        """Return E of a shape (n, 3), and its gradient by the vertices that may move (3c,)."""
        shape = vertices - self._unbent
        bent = self._bending @ shape
        away = (vertices - self._drawing)[self._columns] @ self.axes.T
        pulled = self._pull * away
        value = 0.5 * (dot(shape.ravel(), bent.ravel()) + dot(away.ravel(), pulled.ravel()))
        return value, (bent[self._columns] + pulled @ self.axes).ravel()

    def second_derivative(self) -> sparse.csr_matrix:
        """Return the second derivative of E by the coordinates of the vertices that may move (3c, 3c)."""
        if self._second is None:
            first, second, up = (
                sparse.kron(weight, np.outer(axis, axis)) for weight, axis in zip((self.plan, self.plan, self.height), self.axes)
            )
            self._second = (first + second + up).tocsr()
        return self._second

    def drawn(self) -> bool:
        """Return whether the drawing has no plan, or bends far more than the fairest shape through its supports: someone meant it."""
        if not self._has_plan:
            return True
        return self.bends() and self._bent(self._drawing) > SHAPE_KEPT * self._bent(self.fairest_through(self._drawing))

    def bends(self) -> bool:
        """Return whether the drawing is not flat."""
        return self._bent(self._drawing) > FLAT * self._bending.diagonal().sum()

    def relaxed(self) -> FloatArray:
        """Return the drawing (n, 3) with the heights of the fairest shape through its supports."""
        shape = self._drawing.copy()
        shape[self._columns] += self._metric(None).heights(-self.energy(shape)[1])[:, None] * self.axes[2]
        return shape

    def _bent(self, vertices: FloatArray) -> float:
        return dot(vertices.ravel(), (self._bending @ vertices).ravel())

    def metric(self, freedoms: Freedoms) -> Metric:
        """Return the metric in the free directions, which is also E's second derivative; the last one while they are the same."""
        return self._metric(freedoms)

    def _metric(self, freedoms: Optional[Freedoms]) -> Metric:
        last, basis = self._last, None if freedoms is None else freedoms.basis
        if last is None or not _same(last.basis, basis):
            points = self.points if freedoms is None or basis is None else self._drawing[freedoms.owner]
            last = self._last = Metric(self.plan, self.height, self.axes, points, basis)
        return last

    def fairest_through(self, vertices: FloatArray) -> FloatArray:
        """Return the shape (n, 3) of least energy through the vertices that may not move."""
        shape = vertices.copy()
        step = self._metric(None).solve(-self.energy(vertices)[1])
        shape[self._columns] += step.reshape(-1, 3)
        return shape

    def fairest(self, freedoms: Freedoms) -> FloatArray:
        """Return the cheapest move onto the constraints (3c,)."""
        gap = np.zeros(3 * len(self._columns)) if freedoms.gap is None else freedoms.gap.ravel()
        return self.metric(freedoms).fairest(gap)


def _axes(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, bool]:
    """Return two directions in plan and the one that the mesh faces (3, 3), and whether it faces one at all.

    Taken from the mesh and not from the world, so that a turned model has a turned result.
    """
    a, b, c = vertices[faces[:, 0]], vertices[faces[:, 1]], vertices[faces[:, 2]]
    crosses = np.cross(b - a, c - a)
    facing = crosses.sum(axis=0)
    length = float(np.linalg.norm(facing))
    if not length > FACING * float(np.linalg.norm(crosses, axis=1).sum()):
        return np.eye(3), False
    up = facing / length
    side = np.cross(up, np.eye(3)[np.argmin(np.abs(up))])
    side /= np.linalg.norm(side)
    return np.array([side, np.cross(up, side), up]), True


def _same(one: Optional[sparse.csr_matrix], other: Optional[sparse.csr_matrix]) -> bool:
    if one is None or other is None:
        return one is other
    parts = ("indptr", "indices", "data")
    return one.shape == other.shape and all(np.array_equal(getattr(one, part), getattr(other, part)) for part in parts)


def _flat_vertices(vertices: FloatArray, faces: IntArray, wanted: FloatArray) -> NDArray[np.bool_]:
    """Mark the vertices that are flat for the curvature ``K̄_i A_i`` (n,) wanted of them."""
    normals, mean = face_normals(vertices, faces), vertex_normals(vertices, faces)
    corner = faces.ravel()
    fold = np.zeros(len(vertices))
    np.maximum.at(fold, corner, np.linalg.norm(np.repeat(normals, 3, axis=0) - mean[corner], axis=1))
    return fold < FLAT_FOLD * np.sqrt(np.abs(wanted))


def flat_share(vertices: FloatArray, faces: IntArray, wanted: FloatArray) -> float:
    """Return the part of the curvature ``K̄_i A_i`` (n,) wanted that is wanted of flat vertices."""
    total = float(np.abs(wanted).sum())
    return float(np.abs(wanted[_flat_vertices(vertices, faces, wanted)]).sum()) / total if total > 0.0 else 0.0
