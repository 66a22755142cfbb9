"""The equations, freedoms and metric of one problem, built once."""

from __future__ import annotations

import copy
import math
from dataclasses import replace
from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete import edge_faces
from ...discrete import face_areas
from ...discrete import vertex_areas
from ...discrete import vertex_normals
from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from ...discrete.topology import closed_vertices
from ...model.constraints import Mirror
from ...model.constraints import PositionConstraint
from ...model.problem import CGCProblem
from .fairness import Fairness
from .initial_guess import flat_share
from .iterate import TINY
from .iterate import Point
from .least_norm import LeastNorm
from .linearised import Kept
from .linearised import Linearised
from .placement import Places
from .placement import movable_vertices
from .settings import AUTO
from .settings import ProjectionSettings
from .symmetry import images
from .symmetry import keep_faces
from .vectors import norm

__all__ = ["System"]

EPS = float(np.finfo(float).eps)
SOUND = 1e-6  # area of a face, against the mean, below which its normal means nothing
STEEPEST = 1e8  # derivative of an angle, in the local frame, beyond which it is rounding
FLAT_SHARE = 0.5  # of a drawing, from which its heights mean nothing
RELAXING = 2  # times that drawn heights are let go
SETTLING = 5  # moves that bring a shape onto curved constraints


class System:
    """One problem in its local frame, ready to be solved for any targets.

    Parameters
    ----------
    problem
        The problem in its local frame.
    settings
        Parameters.

    Raises
    ------
    ProblemError
        If a constraint cannot be.
    """

    def __init__(self, problem: CGCProblem, settings: ProjectionSettings):
        V, F, constraints = problem.vertices, problem.faces, problem.constraints
        self.faces = np.ascontiguousarray(F[problem.real_faces])
        areas = face_areas(V, self.faces)
        self.size = math.sqrt(float(areas.sum()))
        self.sound = areas > SOUND * areas.mean()
        edges = edge_faces(self.faces)
        hinges = edges[edges[:, 3] >= 0, 2:]
        self._hinges = np.ascontiguousarray(hinges[self.sound[hinges].all(axis=1)].T)
        movable = movable_vertices(problem, self.faces, constraints)
        self.columns = np.flatnonzero(movable)
        self.rows = np.flatnonzero(problem.asked & closed_vertices(V, F))
        edge = float(np.linalg.norm(V[edges[:, 0]] - V[edges[:, 1]], axis=1).mean())
        symmetries = images(V, edge, [constraint for constraint in constraints if isinstance(constraint, Mirror)])
        self.places = Places(
            V, movable, [constraint for constraint in constraints if isinstance(constraint, PositionConstraint)], symmetries
        )
        # Mirrored equations say the same twice, which makes the systems singular.
        self.leading = np.arange(len(self.rows))
        if len(symmetries) > 1 and keep_faces(F, symmetries):
            self.leading = np.unique(self.places.head[self.rows], return_index=True)[1]

        def fairness(keep: str, rest: FloatArray, smoother: float = 1.0) -> Fairness:
            own = replace(settings, keep=keep, smoothness=smoother * settings.smoothness)
            return Fairness(replace(problem, vertices=rest), self.faces, self.columns, self.size, own, constraints)

        self._fairness = fairness
        self.keep = "plan" if settings.keep == AUTO else settings.keep
        self.fairness = fairness(self.keep, V)
        # Supports pulled out of a flat sheet bend it, but nobody meant it so.
        flat = flat_share(V, self.faces, vertex_areas(V, self.faces) / self.size**2)
        if settings.keep == AUTO and flat < FLAT_SHARE and self.fairness.drawn():
            self.keep, self.fairness = "shape", fairness("shape", V)
        if self.keep != "shape":
            # The drawn heights are not kept, so they must not count in what bending means either.
            for _ in range(RELAXING if self.fairness.bends() else 0):
                self.fairness = fairness(self.keep, self.fairness.relaxed())
        self._equations = CurvatureEquations(F, problem.targets, self.rows, self.columns)
        valence = np.bincount(F.ravel(), minlength=len(V))[self.rows]
        self.floor: FloatArray = EPS * (8.0 + 2.0 * valence.astype(np.float64))  # rounding of a sum of angles (k,) [rad]

    def equations(self, targets: FloatArray) -> CurvatureEquations:
        """Return the equations for targets (n,)."""
        equations = copy.copy(self._equations)
        equations.targets = np.ascontiguousarray(targets)
        return equations

    def keeping(self, keep: str, smoother: float = 1.0) -> System:
        """Return the same system for another setting of what is kept of the drawing, with so many times the smoothness."""
        system = copy.copy(self)
        system.keep, system.fairness = keep, self._fairness(keep, self.places.start, smoother)
        return system

    def at(self, vertices: FloatArray, equations: CurvatureEquations) -> Point:
        """Return what is missing at a shape (n, 3)."""
        residual, areas = equations.measure(vertices)
        gap = self.places.gap(vertices)
        return Point(vertices, residual, areas, gap, math.hypot(norm(residual), norm(gap) / self.size))

    def wanted(self, point: Point, equations: CurvatureEquations) -> FloatArray:
        """Return the angle defects asked for of a shape, zero where none is (n,) [rad]."""
        wanted = np.zeros(len(point.vertices))
        wanted[self.rows] = equations.targets[self.rows] * point.areas
        return wanted

    def missing(self, point: Point, equations: CurvatureEquations) -> float:
        """Return the residuals of a shape as a part of the curvature asked for, or of one over the area where none is."""
        asked = norm(equations.targets[self.rows] * point.areas)
        return norm(point.residual) / max(asked or norm(point.areas) / self.size**2, TINY)

    def linearised(self, point: Point, equations: CurvatureEquations, kept: Optional[Kept] = None) -> Linearised:
        """Return the equations about a shape; what was kept from another shape is used where it fits."""
        freedoms = self.places.freedoms(point.vertices)
        metric, basis = self.fairness.metric(freedoms), freedoms.basis
        J, onto, right = self._jacobian(point, equations), None, -point.residual
        if basis is not None:
            onto = self.fairness.fairest(freedoms)
            right = (right - J @ onto)[self.leading]
            J = (J[self.leading] @ basis).tocsr()

        def across() -> sparse.csr_matrix:
            return freedoms.across(vertex_normals(point.vertices, self.faces)[self.columns].ravel())

        preconditioner = kept.preconditioner if kept is not None and kept.metric is metric else None
        return Linearised(LeastNorm(J, metric, across, preconditioner), onto, right)

    def step(self, point: Point, equations: CurvatureEquations, tolerance: float, kept: Optional[Kept]) -> tuple[FloatArray, Kept]:
        """Return the least-norm step (n, 3), and what to keep for the next one."""
        linear = self.linearised(point, equations, kept)
        found = linear.solver.cheapest(linear.right, tolerance, EPS)
        return self.full(linear.landing(found.move)), linear.kept

    def spread(self, leading: FloatArray) -> FloatArray:
        """Return the values (k,) of all equations for those (l,) of the leading ones, zero for the others."""
        values = np.zeros(len(self.rows))
        values[self.leading] = leading
        return values

    def settled(self, vertices: FloatArray) -> FloatArray:
        """Return a shape (n, 3) moved onto the constraints, by fair moves."""
        for _ in range(SETTLING):
            freedoms = self.places.freedoms(vertices)
            if freedoms.gap is None or np.abs(freedoms.gap).max(initial=0.0) <= EPS:
                break
            vertices = vertices + self.full(self.fairness.fairest(freedoms))
        return vertices

    def folds(self, normals: FloatArray) -> FloatArray:
        """Return the cosine of the angle between the unit normals (m, 3) on the two sides of inner edges."""
        left, right = self._hinges
        return np.einsum("ij,ij->i", np.take(normals, left, axis=0), np.take(normals, right, axis=0))

    def rounding(self, point: Point, equations: CurvatureEquations) -> FloatArray:
        """Return what rounding of the angles and of the coordinates leaves of the residuals (k,) [rad]."""
        slope = np.asarray(abs(self._jacobian(point, equations)).sum(axis=1)).ravel()
        return self.floor + EPS * slope * np.abs(point.vertices[self.columns]).max(initial=0.0)

    def _jacobian(self, point: Point, equations: CurvatureEquations) -> sparse.csr_matrix:
        J = equations.jacobian(point.vertices)
        # What a face without area says of the angles around it means nothing.
        J.data[~(np.abs(J.data) < STEEPEST / self.size)] = 0.0
        return J

    def full(self, move: FloatArray) -> FloatArray:
        """Return the move of all vertices (n, 3) for one of those that may move (3c,)."""
        full = np.zeros((len(self.places.start), 3))
        full[self.columns] = move.reshape(-1, 3)
        return full
