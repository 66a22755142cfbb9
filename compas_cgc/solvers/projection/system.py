"""The equations, freedoms and metric of one problem, built once."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from collections.abc import Sequence
from dataclasses import replace
from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete import edge_faces
from ...discrete import face_areas
from ...discrete import vertex_areas
from ...discrete import vertex_normals
from ...discrete.arrays import EPS
from ...discrete.arrays import Edges
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.jacobian import CurvatureEquations
from ...discrete.topology import closed_vertices
from ...linalg.work import count
from ...linalg.work import rights
from ...meshing.regions import vertex_labels
from ...model.constraints import Mirror
from ...model.goals.binding import BoundGoals
from ...model.goals.binding import UnknownConstant
from ...model.goals.binding import bind
from ...model.goals.binding import unknown_constants
from ...model.measures import read_across
from ...model.problem import CGCProblem
from ..constants import CONVERGED
from ..constants import LOCAL_ROUNDING
from ..constants import MAX_STEPS
from ..constants import SMALLEST_FACE
from .bordered import Bordered
from .bordered import Kept
from .bordered import Linearised
from .contact import Contact
from .fairness import Fairness
from .fairness import flat_share
from .found_curvature import FoundCurvature
from .iterate import SMALLEST_AREA
from .iterate import Point
from .least_norm import LeastNorm
from .placement import Places
from .placement import movable_vertices
from .settings import AUTO
from .settings import ProjectionSettings
from .symmetry import Image
from .symmetry import images
from .symmetry import keep_faces
from .vectors import norm

__all__ = ["System", "relaxed"]

MEASURE = 0.5  # work of measuring the equations [right sides]; estimate of the time, which affects the work limit only
LINES = 3.0  # work of their derivatives [right sides]; estimate of the time, which affects the work limit only
# derivative of an angle in the local frame above which it is dropped [1/L]; an edge of 1e-8, whose direction is a rounding error
STEEPEST = 1e8
# flat share of a drawing above which its heights are not kept; most of it bends nowhere, and half and twice it give the same surfaces
FLAT_SHARE = 0.5
RELAXING = 2  # times that drawn heights are relaxed; half and twice as many give the same surfaces


class System:
    """One problem in its local frame, ready to be solved for any targets.

    Parameters
    ----------
    problem
        The problem in its local frame.
    settings
        Parameters.
    goals
        What constraints ask for. Default: what they say in the local frame.
    found
        Whether K is found where the problem says that it is unknown; else it is taken as given.
    own
        Symmetries that are kept, where no mirrors say which. Default: none.

    Raises
    ------
    ProblemError
        If a constraint cannot be.
    """

    def __init__(
        self,
        problem: CGCProblem,
        settings: ProjectionSettings,
        goals: Optional[BoundGoals] = None,
        found: bool = True,
        own: Sequence[Image] = (),
    ):
        self.goals = bind(problem) if goals is None else goals
        V, F, constraints = problem.vertices, problem.faces, problem.goals
        self.faces = np.ascontiguousarray(F[problem.real_faces])
        areas = face_areas(V, self.faces)
        self.size = math.sqrt(float(areas.sum()))
        self.sound = areas > SMALLEST_FACE * areas.mean()
        edges = edge_faces(self.faces)
        hinges = edges[edges[:, 3] >= 0, 2:]
        self._hinges = np.ascontiguousarray(hinges[self.sound[hinges].all(axis=1)].T)
        movable = movable_vertices(problem, self.faces)
        self.columns = np.flatnonzero(movable)
        self.rows = np.flatnonzero(problem.asked & closed_vertices(V, F))
        self._problem, self._settings = problem, settings
        self._patches: Optional[IntArray] = None
        edge = float(np.linalg.norm(V[edges[:, 0]] - V[edges[:, 1]], axis=1).mean())
        symmetries = list(own) or images(V, edge, [constraint for constraint in constraints if isinstance(constraint, Mirror)])
        self.places = Places(V, movable, self.goals.places, symmetries)
        self.contact = Contact.none(self.goals.sides, movable, edges[:, :2])
        # Mirrored equations say the same twice, which makes the systems singular. Diagonals may be kept by some symmetries only.
        keeping = [image for image in symmetries if image is symmetries[0] or keep_faces(F, [symmetries[0], image])]
        self.torn = len(symmetries) - len(keeping)
        leading = np.arange(len(self.rows))
        if len(keeping) > 1:
            head = self.places.head if not self.torn else np.min([image.to for image in keeping], axis=0)
            leading = np.unique(head[self.rows], return_index=True)[1]
        self._own_leading = leading
        self.leading = np.concatenate([leading, len(self.rows) + np.arange(len(self.goals.equations))])

        def fairness(keep: str, rest: FloatArray, smoother: float = 1.0) -> Fairness:
            own = replace(settings, keep=keep, smoothness=smoother * settings.smoothness)
            return Fairness(replace(problem, vertices=rest), self.faces, self.columns, self.size, own, constraints)

        self._fairness = fairness
        self.keep, self.fairness = self._kept(V)
        groups, factors = _groups(problem, unknown_constants(problem) if found else [], symmetries)
        group, rates = groups[self.rows], factors[self.rows]
        if (group >= 0).any():
            group = np.where(group >= 0, np.unique(group, return_inverse=True)[1] - int((group < 0).any()), -1)

        def curvature_equations(faces: IntArray) -> CurvatureEquations:
            if (group >= 0).any():
                return FoundCurvature(faces, problem.targets, self.rows, self.columns, group, rates, leading)
            return CurvatureEquations(faces, problem.targets, self.rows, self.columns)

        self._equations, across = curvature_equations(F), read_across(problem)
        self._across = self._equations if across is F else curvature_equations(across)
        valence = np.bincount(F.ravel(), minlength=len(V))[self.rows]
        # Rounding of a sum of angles [rad], and of goals (k + g,).
        self.floor: FloatArray = np.append(
            EPS * (8.0 + 2.0 * valence.astype(np.float64)), np.full(len(self.goals.equations), LOCAL_ROUNDING)
        )

    def _kept(self, V: FloatArray) -> tuple[str, Fairness]:
        """Return what is kept of the drawing (n, 3), and what is fair."""
        keep = "plan" if self._settings.keep == AUTO else self._settings.keep
        fairness = self._fairness(keep, V)
        # Supports pulled out of a flat sheet bend it, but nobody meant it so.
        flat = flat_share(V, self.faces, vertex_areas(V, self.faces) / self.size**2)
        if self._settings.keep == AUTO and flat < FLAT_SHARE and fairness.drawn():
            return "shape", self._fairness("shape", V)
        if keep != "shape":
            # The drawn heights are not kept, so they must not count in what bending means either.
            for _ in range(RELAXING if fairness.bends() else 0):
                fairness = self._fairness(keep, fairness.relaxed())
        return keep, fairness

    @property
    def patches(self) -> IntArray:
        """The region of every row (k,)."""
        if self._patches is None:
            self._patches = vertex_labels(len(self._problem.vertices), self._problem.faces, self._problem.regions())[self.rows]
        return self._patches

    def equations(self, targets: FloatArray) -> CurvatureEquations:
        """Return the equations for targets (n,)."""
        return _for(self._equations, targets)

    def across_corners(self, targets: FloatArray) -> CurvatureEquations:
        """Return the equations for targets (n,), across the faces that the smooth measure reads."""
        return _for(self._across, targets)

    def keeping(self, keep: str, smoother: float = 1.0) -> System:
        """Return the same system for another setting of what is kept of the drawing, with so many times the smoothness."""
        system = copy.copy(self)
        system.keep, system.fairness = keep, self._fairness(keep, self.places.start, smoother)
        return system

    @property
    def creases(self) -> Edges:
        """Edges (c, 2) that are creases."""
        return self._problem.creases

    @property
    def asks_for_k_alone(self) -> bool:
        """Whether nothing but K binds the vertices that may move."""
        return self.places.trivial and not self.goals.equations and not self.goals.sides

    @property
    def can_be_laid_out_anew(self) -> bool:
        """Whether there is nothing but vertices and creases to hold, so that other triangles do as well."""
        return not self._problem.goals and bool(self._problem.real_faces.all())

    def on(self, vertices: FloatArray, faces: IntArray) -> System:
        """Return the system of a shape (n, 3), which is kept, on other triangles (m, 3)."""
        return System(replace(self._problem, vertices=vertices, faces=faces), replace(self._settings, keep="shape"), self.goals)

    def without_goals(self, keep_contact: bool = False) -> System:
        """Return the same system without the goals of the whole surface, and without sides to keep to unless contact is kept."""
        system = copy.copy(self)
        system.goals = self.goals._replace(equations=(), sides=self.goals.sides if keep_contact else ())
        if not keep_contact:
            system.contact = Contact.none((), self.places.movable, self.contact.edges)
            system.places = self.places.holding(())
        system.leading, system.floor = self._own_leading, self.floor[: len(self.rows)]
        return system

    def renewed(self, point: Point, equations: CurvatureEquations, multipliers: Optional[FloatArray]) -> System:
        """Return the system with the vertices that touch their sides at a shape, for the multipliers (l,) of the leading equations."""
        if not self.goals.sides:
            return self
        force = None if multipliers is None else self.force(point, equations, multipliers)
        contact = self.contact.renewed(point.vertices, force)
        system = copy.copy(self)
        system.contact = contact
        if not contact.same(self.contact):
            system.places = self.places.holding(contact.constraints())
        return system

    def touching(self, point: Point, equations: CurvatureEquations) -> System:
        """Return the system with the vertices of a finished shape that touch their sides and press against them."""
        if not self.goals.sides:
            return self
        system = copy.copy(self)
        system.contact = self.contact.at(point.vertices)
        system.places = self.places.holding(system.contact.constraints())
        linear = system.linearised(point, equations)
        energy = system.fairness.energy(point.vertices)[1]
        multipliers = linear.solver.without_effect(-linear.reduced(energy), CONVERGED)[1]
        return system.renewed(point, equations, multipliers)

    def force(self, point: Point, equations: CurvatureEquations, multipliers: FloatArray) -> FloatArray:
        """Return the gradient of the Lagrangian at a shape (n, 3), for the multipliers (l,) of the leading equations."""
        k, weights = len(self.rows), self.spread(multipliers)
        gradient = self.full(self.fairness.energy(point.vertices)[1] + self.jacobian(point, equations).T @ weights[:k])
        for row, weight in zip(self._goal_rows(point.vertices), weights[k:]):
            gradient = gradient + weight * row
        if len(self.places.symmetries) > 1:
            gradient = self.places.symmetric_vectors(gradient)
        return gradient

    def hessian(self, equations: CurvatureEquations, vertices: FloatArray, weights: FloatArray) -> Callable[[FloatArray], FloatArray]:
        """Return what tells how the gradient of the equations weighed by (k + g,) changes along a move (n, 3)."""
        k = len(self.rows)
        of_defects = equations.hessian(vertices, weights[:k])

        def along(moves: FloatArray) -> FloatArray:
            change = of_defects.along(moves)
            for equation, weight in zip(self.goals.equations, weights[k:]):
                change = change + weight / self.size**equation.power * equation.curvature_along(vertices, moves)
            return change

        return along

    def at(self, vertices: FloatArray, equations: CurvatureEquations) -> Point:
        """Return what is missing at a shape (n, 3)."""
        count(rights(MEASURE, 3 * len(vertices)))
        residual, areas = equations.measure(vertices)
        if self.goals.equations:
            lacking = [(own.value(vertices) - own.wanted) / self.size**own.power for own in self.goals.equations]
            residual = np.append(residual, lacking)
        gap = self.places.gap(vertices)
        if self.goals.sides:
            gap = np.maximum(gap, self.contact.crossed(vertices))
        return Point(vertices, residual, areas, gap, math.hypot(norm(residual), norm(gap) / self.size))

    def problem_at(self, vertices: FloatArray, targets: FloatArray) -> CGCProblem:
        """Return the problem in its local frame with a shape (n, 3) and targets (n,)."""
        return replace(self._problem, vertices=vertices, targets=targets)

    def wanted(self, point: Point, equations: CurvatureEquations) -> FloatArray:
        """Return the angle defects asked for of a shape, zero where none is (n,) [rad]."""
        wanted = np.zeros(len(point.vertices))
        wanted[self.rows] = equations.targets[self.rows] * point.areas
        return wanted

    def missing(self, point: Point, equations: CurvatureEquations) -> float:
        """Return the residuals of a shape as a part of the curvature asked for, or of one over the area where none is."""
        asked = norm(equations.targets[self.rows] * point.areas)
        return norm(point.residual) / max(asked or norm(point.areas) / self.size**2, SMALLEST_AREA)

    def linearised(self, point: Point, equations: CurvatureEquations, kept: Optional[Kept] = None) -> Linearised:
        """Return the equations about a shape; what was kept from another shape is used where it fits."""
        count(rights(LINES, 3 * len(point.vertices)))
        freedoms = self.places.freedoms(point.vertices)
        metric, basis = self.fairness.metric(freedoms), freedoms.basis
        J, onto, right = self.jacobian(point, equations), None, -point.residual
        leading = self._own_leading
        common = equations.common(point.areas, leading) if isinstance(equations, FoundCurvature) else None
        dense = np.array([row[self.columns].ravel() for row in self._goal_rows(point.vertices)]).reshape(-1, 3 * len(self.columns))
        if basis is not None:
            onto = self.fairness.fairest(freedoms)
            right = right - np.concatenate([J @ onto, dense @ onto])
            J = (J[leading] @ basis).tocsr()
            dense = np.ascontiguousarray((basis.T @ dense.T).T)
        right = right[self.leading]
        if common is not None:
            right = np.concatenate([common.removed(right[: len(leading)]), right[len(leading) :]])

        def across() -> sparse.csr_matrix:
            return freedoms.across(vertex_normals(point.vertices, self.faces)[self.columns].ravel())

        preconditioner = kept.preconditioner if kept is not None and kept.metric is metric else None
        sparse = LeastNorm(J, metric, across, preconditioner, common)
        return Linearised(Bordered(sparse, dense) if len(dense) else sparse, onto, right)

    def step(
        self, point: Point, equations: CurvatureEquations, tolerance: float, kept: Optional[Kept]
    ) -> tuple[FloatArray, Optional[Kept]]:
        """Return the least-norm step (n, 3), and what to keep for the next one."""
        linear = self.linearised(point, equations, kept)
        found = linear.solver.cheapest(linear.right, tolerance, EPS)
        return self.full(linear.landing(found.move)), linear.kept

    def spread(self, leading: FloatArray) -> FloatArray:
        """Return the values (k + g,) of all equations for those (l,) of the leading ones, zero for the others."""
        values = np.zeros(len(self.rows) + len(self.goals.equations))
        values[self.leading] = leading
        return values

    def settled(self, vertices: FloatArray) -> FloatArray:
        """Return a shape (n, 3) moved onto the constraints, by fair moves."""
        if self.places.trivial:
            return vertices
        for _ in range(MAX_STEPS):
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
        """Return what rounding of the angles and of the coordinates leaves of the residuals (k + g,) [rad]."""
        slope = np.asarray(abs(self.jacobian(point, equations)).sum(axis=1)).ravel()
        slope = np.append(slope, np.full(len(self.goals.equations), LOCAL_ROUNDING / EPS))
        return self.floor + EPS * slope * np.abs(point.vertices[self.columns]).max(initial=0.0)

    def jacobian(self, point: Point, equations: CurvatureEquations) -> sparse.csr_matrix:
        """Return the derivatives of the residuals by the coordinates that may move (k, 3c)."""
        J = equations.jacobian(point.vertices)
        # What a face without area says of the angles around it means nothing.
        J.data[~(np.abs(J.data) < STEEPEST / self.size)] = 0.0
        return J

    def _goal_rows(self, vertices: FloatArray) -> list[FloatArray]:
        """Return the derivatives (n, 3) of what goals of the whole surface lack."""
        return [own.gradient(vertices) / self.size**own.power for own in self.goals.equations]

    def full(self, move: FloatArray) -> FloatArray:
        """Return the move of all vertices (n, 3) for one of those that may move (3c,)."""
        full = np.zeros((len(self.places.start), 3))
        full[self.columns] = move.reshape(-1, 3)
        return full


def _for(equations: CurvatureEquations, targets: FloatArray) -> CurvatureEquations:
    """Return equations for other targets (n,)."""
    other = copy.copy(equations)
    other.targets = np.ascontiguousarray(targets)
    return other


def _groups(problem: CGCProblem, unknown: list[UnknownConstant], symmetries: Sequence[Image]) -> tuple[IntArray, FloatArray]:
    """Return the number of the unknown K at every vertex, -1 where it is given, and K there per unknown (n,).

    Regions that are images share their number.
    """
    group, rates = np.full(len(problem.vertices), -1), np.ones(len(problem.vertices))
    for number, constant in enumerate(unknown):
        for region in constant.regions:
            own = problem.region_vertices(region) & (group < 0)
            group[own] = number
            rates[own] = problem.targets[own] if constant.is_factor else 1.0
    for image in symmetries[1:]:
        both = (group >= 0) & (group[image.to] >= 0)
        for one, other in np.unique(np.column_stack([group, group[image.to]])[both], axis=0).tolist():
            group[group == max(one, other)] = min(one, other)
    return group, rates


def relaxed(problem: CGCProblem) -> FloatArray:
    """Return the shape (n, 3) that bends least over the supports of a problem, whatever is drawn between them [L]."""
    local, frame = problem.local()
    system = System(local, ProjectionSettings(keep="plan"), bind(local, problem.goals))
    return frame.to_model(system.settled(system.fairness.relaxed()))
