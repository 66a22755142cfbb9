"""The equations, freedoms and metric of one problem, built once."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse

from ..discrete import edge_faces
from ..discrete import face_areas
from ..discrete import vertex_areas
from ..discrete import vertex_normals
from ..discrete.arrays import FloatArray
from ..discrete.jacobian import CurvatureEquations
from ..discrete.topology import closed_vertices
from ..problem import CREASE
from ..problem import CGCProblem
from .constraints import Constraint
from .constraints import Held
from .constraints import Mirror
from .constraints import Near
from .constraints import Placing
from .constraints import indices
from .freedoms import Freedoms
from .freedoms import Places
from .metric import Metric
from .metric import bending_matrix
from .settings import ProjectionSettings
from .step import Preconditioner
from .step import least_norm
from .symmetry import images
from .symmetry import keep_faces
from .vectors import norm

__all__ = ["Point", "System"]

EPS = float(np.finfo(float).eps)
TINY = 1e-100  # keeps the error of a vertex without area a number
SOUND = 1e-6  # area of a face, against the mean, below which its normal means nothing
LEAST_MASS = 1e-6  # of a vertex, against the mean
SETTLING = 5  # moves that bring a shape onto curved constraints
SEED_MASS = 1e-4  # what holds a seed that nothing else holds


class Point(NamedTuple):
    """A shape with what is missing from what is asked of it."""

    vertices: FloatArray  # (n, 3)
    residual: FloatArray  # (k,) defect_i - K̄_i A_i at the vertices with an equation [rad]
    areas: FloatArray  # (k,) A_i
    gap: FloatArray  # (n,) distance from fulfilling the constraints
    merit: float  # norm of residuals and gaps, which the line search makes smaller

    @property
    def error(self) -> FloatArray:
        """|K - K̄| at the vertices with an equation (k,)."""
        return np.abs(self.residual) / np.maximum(self.areas, TINY)

    @property
    def max_error(self) -> float:
        """Largest |K - K̄|."""
        return float(self.error.max(initial=0.0))

    @property
    def error_norm(self) -> float:
        """Norm of K - K̄, κ of Eq. 30."""
        return norm(self.error)


class System:
    """One problem in its local frame, ready to be solved for any targets.

    Parameters
    ----------
    problem
        The problem in its local frame.
    settings
        Parameters.
    constraints
        Constraints in the local frame.

    Raises
    ------
    ProblemError
        If a constraint cannot be.
    """

    def __init__(self, problem: CGCProblem, settings: ProjectionSettings, constraints: Sequence[Constraint]):
        V, F = problem.vertices, problem.faces
        self.faces = np.ascontiguousarray(F[problem.real_faces])
        used = np.zeros(len(V), bool)
        used[self.faces.ravel()] = True
        movable = problem.movable & used
        for constraint in constraints:
            if isinstance(constraint, Held):
                movable[indices(constraint.vertices, len(V))] = False
        self.rows = np.flatnonzero(problem.asked & closed_vertices(V, F))
        self.columns = np.flatnonzero(movable)
        self._size = len(V)
        self.size = math.sqrt(float(face_areas(V, self.faces).sum()))
        edges = edge_faces(self.faces)
        areas = face_areas(V, self.faces)
        self.sound = areas > SOUND * areas.mean() if len(areas) else np.zeros(0, bool)
        hinges = edges[edges[:, 3] >= 0, 2:]
        self._hinges = hinges[self.sound[hinges].all(axis=1)]
        ends = V[edges[:, :2]]
        edge = float(np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1).mean()) if len(edges) else 0.0
        symmetries = images(V, edge, [constraint for constraint in constraints if isinstance(constraint, Mirror)])
        self.places = Places(V, movable, [constraint for constraint in constraints if isinstance(constraint, Placing)], symmetries)
        # Mirrored equations say the same twice, which makes the systems singular.
        self._leading = np.arange(len(self.rows))
        if len(symmetries) > 1 and keep_faces(F, symmetries):
            self._leading = np.unique(self.places.head[self.rows], return_index=True)[1]
        mass = vertex_areas(V, self.faces)
        mass = np.maximum(mass, LEAST_MASS * mass[used].mean()) if used.any() else mass
        bending = self.size**4 * bending_matrix(V, self.faces, problem.roles == CREASE, settings.crease_stiffness)
        self._nearness = sparse.diags(settings.nearness * _weights(constraints, len(V)) * mass)
        self._bending = bending
        self._set_smoothness(settings.smoothness)
        self.stiffness = (SEED_MASS * sparse.diags(mass) + bending).tocsr()
        valence = np.bincount(F.ravel(), minlength=len(V))[self.rows]
        self.floor = EPS * (8.0 + 2.0 * valence)  # rounding of a sum of angles (k,) [rad]
        self._equations = CurvatureEquations(F, problem.targets, self.rows, self.columns)

    def equations(self, targets: FloatArray) -> CurvatureEquations:
        """Return the equations for targets (n,)."""
        equations = copy.copy(self._equations)
        equations.targets = np.ascontiguousarray(targets)
        return equations

    def smoother(self, factor: float) -> System:
        """Return the same system with another smoothness."""
        system = copy.copy(self)
        system._set_smoothness(factor * self._smoothness)
        return system

    def at(self, vertices: FloatArray, equations: CurvatureEquations) -> Point:
        """Return what is missing at a shape (n, 3)."""
        residual, areas = equations.measure(vertices)
        gap = self.places.gap(vertices)
        merit = math.hypot(norm(residual), norm(gap) / self.size)
        return Point(vertices, residual, areas, gap, merit)

    def step(
        self, point: Point, equations: CurvatureEquations, tolerance: float, preconditioner: Optional[Preconditioner]
    ) -> tuple[FloatArray, Optional[Preconditioner]]:
        """Return the least-norm step (n, 3), and a preconditioner for the next one."""
        J = equations.jacobian(point.vertices)
        normals = vertex_normals(point.vertices, self.faces)[self.columns].ravel()
        freedoms = self.places.freedoms(point.vertices)
        metric = self._metric_on(freedoms)
        if metric is not self._metric:
            self._metric, preconditioner = metric, None
        right, basis = -point.residual[self._leading], freedoms.basis
        if basis is None:
            move, preconditioner = least_norm(J, right, metric, freedoms.across(normals), tolerance, EPS, preconditioner)
        else:
            J = J[self._leading]
            onto = metric.fairest(freedoms.gap.ravel())
            right = right - J @ onto
            along, preconditioner = least_norm((J @ basis).tocsr(), right, metric, freedoms.across(normals), tolerance, EPS, preconditioner)
            move = onto + basis @ along
        return self._full(move), preconditioner

    def settled(self, vertices: FloatArray) -> FloatArray:
        """Return a shape (n, 3) moved onto the constraints, by fair moves."""
        for _ in range(SETTLING):
            freedoms = self.places.freedoms(vertices)
            if freedoms.gap is None or np.abs(freedoms.gap).max(initial=0.0) <= EPS:
                break
            self._metric = self._metric_on(freedoms)
            vertices = vertices + self._full(self._metric.fairest(freedoms.gap.ravel()))
        return vertices

    def folds(self, normals: FloatArray) -> FloatArray:
        """Return the cosine of the angle between the unit normals (m, 3) on the two sides of inner edges."""
        return np.einsum("ij,ij->i", normals[self._hinges[:, 0]], normals[self._hinges[:, 1]])

    def rounding(self, point: Point, equations: CurvatureEquations) -> FloatArray:
        """Return what rounding of the angles and of the coordinates leaves of the residuals (k,) [rad]."""
        slope = np.asarray(abs(equations.jacobian(point.vertices)).sum(axis=1)).ravel()
        return self.floor + EPS * slope * np.abs(point.vertices[self.columns]).max(initial=0.0)

    def _metric_on(self, freedoms: Freedoms) -> Metric:
        if self._metric is not None and _same(self._metric.basis, freedoms.basis):
            return self._metric
        return Metric(self._cost, freedoms.basis)

    def _full(self, move: FloatArray) -> FloatArray:
        full = np.zeros((self._size, 3))
        full[self.columns] = move.reshape(-1, 3)
        return full

    def _set_smoothness(self, smoothness: float) -> None:
        self._smoothness = smoothness
        cost = (self._nearness + smoothness**4 * self._bending).tocsr()
        self._cost = cost[self.columns][:, self.columns]
        self._metric: Optional[Metric] = None


def _weights(constraints: Sequence[Constraint], n: int) -> FloatArray:
    weights = np.ones(n)
    for constraint in constraints:
        if isinstance(constraint, Near):
            weights[indices(constraint.vertices, n)] *= constraint.weight
    return weights


def _same(one: Optional[sparse.csr_matrix], other: Optional[sparse.csr_matrix]) -> bool:
    if one is None or other is None:
        return one is other
    return one.shape == other.shape and all(
        np.array_equal(getattr(one, name), getattr(other, name)) for name in ("indptr", "indices", "data")
    )
