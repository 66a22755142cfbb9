"""System of the curvature equations of one problem, with one unknown per vertex where K is asked for."""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import Callable
from typing import NamedTuple

import numpy as np
from scipy import sparse

from ...discrete import _kernels
from ...discrete.arrays import EPS
from ...discrete.arrays import FloatArray
from ...discrete.arrays import Vertices
from ...discrete.evaluation import Measure
from ...discrete.jacobian import CurvatureEquations
from ...discrete.smooth_measure import layout_errors
from ...discrete.space_form import SpaceFormEquations
from ...discrete.space_form import exact_equations
from ...linalg import LinearSolver
from ...linalg import linear_solver
from ...linalg import nearly_solved
from ...model.laws import types_of
from ...model.problem import CGCProblem
from ..constants import LARGE_MESH
from ..constants import LOCAL_ROUNDING

__all__ = ["Shape", "Step", "System"]

Solve = Callable[[FloatArray], FloatArray]


class Shape(NamedTuple):
    """A surface as Newton's method sees it, at the k vertices where K is asked for."""

    vertices: Vertices  # (n, 3) all coordinates [L]
    residual: FloatArray  # (k,) defect_i - K̄_i A_i [rad]
    curvature: FloatArray  # (k,) K of Eq. 10 [1/L^2]
    mean: FloatArray  # (k,) mean curvature, positive where convex towards the normal [1/L]
    area: FloatArray  # (k,) A_i [L^2]
    normal: FloatArray  # (k, 3) n_i of Eq. 13
    energy: float  # Φ [L]

    @property
    def largest(self) -> float:
        """Largest residual [rad]; infinite when one is not a number."""
        largest = float(np.abs(self.residual).max(initial=0.0))
        return largest if np.isfinite(largest) else np.inf


class Step(NamedTuple):
    """One step and where it led."""

    shape: Shape
    length: float  # damping factor, 1 for a whole step
    trials: int  # factors tried


class System:
    """What stays the same from step to step: sparsity, order of elimination, measures.

    Parameters
    ----------
    problem
        In its local frame.
    backend
        See :func:`compas_cgc.linalg.linear_solver`.

    Raises
    ------
    MeshError
        If K is asked for where no closed ring of faces measures it.
    """

    def __init__(self, problem: CGCProblem, backend: str):
        self.problem = problem
        self.asked = np.flatnonzero(problem.asked)
        self.targets = problem.targets[self.asked]
        self.scale = problem.target_scale
        self.size = float(np.linalg.norm(np.ptp(problem.vertices, axis=0)))  # diagonal of the model [L]
        self.equations: CurvatureEquations = CurvatureEquations(problem.faces, problem.targets, self.asked, self.asked)
        self.solver: LinearSolver = linear_solver(len(self.asked), points=problem.vertices[self.asked], backend=backend)
        self.layout: FloatArray = np.zeros(len(problem.targets))  # angle defects over areas on a surface with K, less K [1/L^2]
        self.factorised = False  # whether there are factors of a matrix near to that of the next step
        self.measures = Measure(problem.vertices, problem.faces, problem.face_targets())

    def exactly(self, measure: str) -> System:
        """Return the same system in an exact measure of K, itself for any other."""
        equations = exact_equations(self.equations, measure)
        if equations is self.equations:
            return self
        system = copy.copy(self)
        system.equations = equations
        return system

    @property
    def many(self) -> bool:
        """Whether there are so many unknowns that factors take longer than some rounds with old ones."""
        return len(self.asked) >= LARGE_MESH

    def solving(self, matrix: sparse.csr_matrix) -> Solve:
        """Return the solution (k,) of a linear system (k, k) by right sides (k,).

        Raises
        ------
        SingularMatrixError
            If the system has no solution.
        """
        self.solver.factorise(matrix)
        self.factorised = True
        return self.solver.solve

    def solving_nearly(self, matrix: sparse.csr_matrix, tolerance: float) -> Solve:
        """Return the same, of a large system to a loose tolerance: rounds with earlier factors take a fraction of the time of new ones.

        Parameters
        ----------
        matrix
            ``(k, k)``.
        tolerance
            Residual, as a part of the right side.
        """
        if not self.factorised or not self.many:
            return self.solving(matrix)

        def solve(right: FloatArray) -> FloatArray:
            found = nearly_solved(matrix, self.solver.solve, right, tolerance)
            return self.solving(matrix)(right) if found is None else found

        return solve

    def layout_at(self, vertices: Vertices) -> FloatArray:
        """Return the angle defects over areas (n,), other than K, that the layout of the mesh has on a surface like a shape (n, 3)."""
        return layout_errors(vertices, self.problem.faces, self.problem.asked)

    def with_layout(self, layout: FloatArray) -> System:
        """Return the same system for angle defects that differ from the targets by those of a layout (n,)."""
        system, targets = copy.copy(self), self.problem.targets + layout
        system.layout, system.targets = layout, targets[self.asked]
        system.equations = copy.copy(self.equations)
        system.equations.targets = targets
        return system

    def with_curvature(self, K: float) -> System:
        """Return the same system for another K everywhere."""
        system = copy.copy(self)
        system.problem = replace(self.problem, targets=np.full(len(self.problem.targets), K))
        system.scale = system.problem.target_scale
        return system.with_layout(self.layout)

    def measure(self, vertices: Vertices) -> Shape:
        """Return the measures of a shape with vertices (n, 3), the mean curvature by Eq. 14."""
        here = self.measures(vertices)
        K, A, N = here.curvature[self.asked], here.area[self.asked], here.normal[self.asked]
        vectors = _kernels.mean_curvature_vectors(vertices, self.problem.faces)[self.asked]
        with np.errstate(all="ignore"):
            H = -0.5 * np.einsum("ij,ij->i", vectors, N) / A
        residual = (K - self.targets) * A
        if isinstance(self.equations, SpaceFormEquations):
            residual = self.equations.residual(vertices)
            K = self.targets + residual / A
        return Shape(vertices, residual, K, H, A, N, here.energy)

    def moved(self, shape: Shape, lengths: FloatArray, directions: FloatArray) -> Shape:
        """Return the shape with its vertices moved by lengths (k,) [L] along unit directions (k, 3)."""
        vertices = shape.vertices.copy()
        vertices[self.asked] += lengths[:, None] * directions
        return self.measure(vertices)

    def errors(self, shape: Shape) -> tuple[float, float]:
        """Return the largest |K - K̄| and the norm κ of Eq. 30."""
        error = shape.curvature - self.targets
        if not error.size:
            return 0.0, 0.0
        return float(np.abs(error).max()), float(np.linalg.norm(error))

    def meets(self, shape: Shape, tolerance: float) -> bool:
        """Return whether no |K - K̄| exceeds this part of the largest |K̄|, or what does is rounding."""
        return bool((np.abs(shape.residual) <= np.maximum(tolerance * self.scale * shape.area, LOCAL_ROUNDING)).all())

    def dents(self, shape: Shape) -> int:
        """Return how many vertices bend the other way than most, of those where K̄ > 0."""
        elliptic = types_of(self.targets) > 0
        inwards = int((shape.mean[elliptic] < 0).sum())
        return min(inwards, int(elliptic.sum()) - inwards)

    def rounding_floor(self, shape: Shape) -> FloatArray:
        """Return how far rounding the coordinates moves each residual (k,) [rad]."""
        J = abs(self.equations.jacobian(shape.vertices))
        return EPS * (2 * np.pi + J @ np.abs(shape.vertices[self.asked]).ravel())
