"""Energy and curvature equations of a surface by mid-edge normals, with exact first and second derivatives."""

from __future__ import annotations

import copy
import math
from functools import cached_property
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Mask
from ...discrete.measured_curvature import even_angles
from ...discrete.mid_edge import OCCURRENCES
from ...discrete.mid_edge import TRACE
from ...discrete.mid_edge import MidEdgeMesh
from ...discrete.mid_edge import ShapeOperators
from ...discrete.mid_edge import determinants
from ...model.laws import ConstantCurvature
from ...model.laws import Piecewise
from .conditions import Conditions
from .conditions import Met
from .sparsity import Model
from .sparsity import Parts
from .sparsity import Pattern
from .turns import Turns
from .turns import free_turns
from .turns import no_turns

__all__ = ["Lagrangian", "State"]

MOMENT_DIGITS = 6  # compared digits of moments at unit size; so that rounding errors do not order mirror twins
DETERMINANT = np.outer(TRACE, TRACE) - np.diag(OCCURRENCES)  # second derivative of the second invariant of a packed matrix


class State(NamedTuple):
    """Unknowns and what they give."""

    unknowns: FloatArray  # (u,) moves of the vertices [L], then angles [rad]
    operators: ShapeOperators
    energy: float
    residuals: FloatArray  # (r,) integrals of the residuals of the laws over the cells of the equations
    met: Met  # conditions of goals

    @property
    def equations(self) -> FloatArray:
        """The residuals and the distances from places (r + k,)."""
        return np.concatenate([self.residuals, self.met.places])

    @property
    def missed(self) -> FloatArray:
        """By what laws and conditions of goals are missed in all (2,)."""
        return np.array([np.abs(self.residuals).sum(), np.abs(self.met.missed).sum() + np.abs(self.met.places).sum()])

    def merit(self, weights: FloatArray) -> float:
        """Return the energy plus weights (2,) times what is missed."""
        return self.energy + float(weights @ self.missed)


class Lagrangian:
    r"""Bending, folding and the curvature equations of one problem.

    .. math:: E = \sum_f A_f |S_f|^2 + \frac1\ell \sum_e l_e \vartheta_e^2 + \frac1{d^4} \sum_i A_i u_i^2
                  + \sum_p \sum_{f \in p} A_f |S_f - L_p|^2, \qquad
              r_p = A_p f_p(H_p, K_p), \\
              H_p = \frac{\operatorname{tr} T_p}{2 A_p}, \qquad K_p = \frac{\det T_p}{A_p^2},

    with the laws :math:`f_p = 0`, such as :math:`K - \bar K = 0`, the folds :math:`\vartheta_e` of crease edges, the moves
    :math:`u_i` of the vertices and their areas :math:`A_i`, the linear functions :math:`L_p` fitted to
    the shape operators about every pair of vertex and region, and the sums :math:`T_p` of
    :math:`A_f S_f` and :math:`A_p` of areas over its faces.

    Parameters
    ----------
    mesh
        Triangles, angles and directions.
    drawing
        ``(n, 3)`` the vertices before they move [L].
    free
        ``(n,)`` vertices that move.
    rows
        ``(r,)`` pairs where an equation holds.
    law
        The laws of these pairs.
    fold_length
        ℓ: a strip of this width beside a crease bends as easily as the crease folds [L].
    conditions
        Of goals.
    pattern
        Of the same problem over another drawing.
    """

    side = 1.0  # to which domes rise first: 1 along the directions, -1 against them
    waves = math.inf  # d: shorter waves of the drawing are smoothed, longer ones kept [L]

    def __init__(
        self, mesh: MidEdgeMesh, drawing: FloatArray, free: Mask, rows: IntArray, law: Piecewise, fold_length: float,
        conditions: Conditions, pattern: Optional[Pattern] = None,
    ):  # fmt: skip
        self.mesh, self.drawing, self.rows, self.law, self.conditions = mesh, drawing, rows, law, conditions
        self._posed = free, rows, law, fold_length, conditions
        self.free: IntArray = np.concatenate([np.flatnonzero(free), np.arange(len(drawing), mesh.unknowns)])
        self.moves = int(free.sum())  # of the free unknowns, those that are moves come first
        ends = drawing[mesh.angles.ends[mesh.angles.folds[:, 0]]]
        self._fold_columns = len(drawing) + mesh.angles.folds
        self._fold_weights = 2.0 / fold_length * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        areas = mesh.at(drawing, np.zeros(len(mesh.angles.ends))).areas
        self.cells: FloatArray = (mesh.incidence @ areas)[self.rows]
        self.scales = law.scales(float(areas.sum()))  # that the residuals of the laws are compared with (r,)
        self.kept: FloatArray = np.zeros(mesh.unknowns)  # second derivatives of the energy that keeps the drawing (u,)
        # what shape operators that cost no bending take from its derivatives by tensors (m, 6), and add to those by areas (m,)
        self._spared: tuple[FloatArray, FloatArray] = np.zeros((len(mesh.faces), 6)), np.zeros(len(mesh.faces))
        self.folded_as: FloatArray = np.zeros(len(mesh.angles.folds))  # folds of crease edges that cost nothing (c,) [rad]
        self.pattern = Pattern(self) if pattern is None else pattern.copied()
        # It is of fourth order in the length of edges, so that it vanishes under refinement, and it removes oscillations that bending
        # hardly sees. Heights err least for the weight 1 among 0, .1, 1 and 10.
        self.uneven = self.pattern.unevenness(self, areas)

    @property
    def size(self) -> int:
        """Number of free unknowns."""
        return len(self.free)

    @property
    def count(self) -> int:
        """Number of equations: laws, then places."""
        return len(self.rows) + len(self.conditions.vertices)

    @cached_property
    def turns(self) -> Turns:
        """Moves by which supports leave a plan free to turn; none where the shape of the drawing is kept."""
        mesh, free = self.mesh, self._posed[0].copy()
        free[self.conditions.lone] = False
        return free_turns(self.drawing, mesh.faces, mesh.directions[0], free) if self.has_plan else no_turns(len(free))

    def border(self, met: Met, active: Mask) -> FloatArray:
        """Return the border (q + r + k, b) of the saddle matrix: surfaces are not turned, and active conditions (c,) are met."""
        moved = self.free[: self.moves]
        columns = np.hstack([self.turns.conditions[moved], met.slopes[np.flatnonzero(active)][:, moved].T.toarray()])
        return np.pad(columns, ((0, self.size + self.count - self.moves), (0, 0)))

    def products(self, values: FloatArray, active: Mask) -> FloatArray:
        """Return the products (b,) with the border of steps that make the values (c,) of active conditions zero."""
        return np.concatenate([np.zeros(self.turns.conditions.shape[1]), -values[active]])

    def forces_of(self, pushed: FloatArray, active: Mask) -> FloatArray:
        """Return the forces (c,) of conditions from the multipliers (b,) of the products with the border."""
        forces = np.zeros(len(active))
        forces[active] = pushed[self.turns.conditions.shape[1] :]
        return forces

    def moves_of(self, solution: FloatArray) -> FloatArray:
        """Return the moves (n,) of a solution of the saddle system (q + r + k,)."""
        moves = np.zeros(len(self.drawing))
        moves[self.free[: self.moves]] = solution[: self.moves]
        return moves

    @property
    def held(self) -> IntArray:
        """Vertices that do not move."""
        return np.setdiff1d(np.arange(len(self.drawing)), self.free)

    @property
    def types(self) -> FloatArray:
        """Signs of the discriminants of the laws of the equations on flat surfaces: 1 elliptic, 0 parabolic, -1 hyperbolic (r,)."""
        flat = np.zeros(len(self.rows))
        return np.sign(self.law.discriminant(flat, flat))

    @property
    def is_determined(self) -> bool:
        """Whether elliptic laws within held boundaries and creases leave the energy no choice."""
        sides = self.mesh.angles.ends[np.bincount(self.mesh.angles.of_faces.ravel()) == 1]
        return bool((self.types > 0.0).all()) and not self._posed[0][sides].any()

    @property
    def is_parabolic(self) -> bool:
        """Whether all laws are parabolic, such as K̄ = 0."""
        return bool((self.types == 0.0).all())

    @property
    def is_minimal(self) -> bool:
        """Whether the supports determine a minimal surface."""
        shape = self.law.shape()
        return self.is_determined and not (shape.mean.any() or shape.round.any())

    @property
    def has_plan(self) -> bool:
        """Whether all vertices move along one direction."""
        return bool((self.mesh.directions == self.mesh.directions[0]).all())

    def keeping(self, waves: float) -> Lagrangian:
        """Return the same with a drawing that is kept but for waves shorter than a length [L]."""
        other, n = copy.copy(self), len(self.drawing)
        areas = self.mesh.at(self.drawing, np.zeros(len(self.mesh.angles.ends))).areas
        other.waves, other.kept, other.turns = waves, np.zeros(self.mesh.unknowns), no_turns(n)
        other.kept[:n] = 2.0 / 3.0 * np.bincount(self.mesh.faces.ravel(), np.repeat(areas, 3), n) / waves**4
        return other

    def near(self, waves: float, importance: FloatArray) -> Lagrangian:
        """Return the same with a smooth drawing that is kept, bends and folds included, but for changes on waves shorter than a length.

        Parameters
        ----------
        waves
            The length [L].
        importance
            ``(n,)`` factors of the moves.
        """
        other, n = self.keeping(waves), len(self.drawing)
        other.kept[:n] *= importance**2
        drawn = np.append(np.zeros(n), even_angles(self.mesh, self.drawing))
        operators = self.mesh.at(self.drawing, drawn[n:])
        bent_as = operators.tensors / operators.areas[:, None]
        other._spared, other.folded_as = (2.0 * OCCURRENCES * bent_as, bent_as**2 @ OCCURRENCES), self.folds(drawn)
        return other

    def evener(self, evenness: float) -> Lagrangian:
        """Return the same with an energy of the second derivatives of the curvature, times the fourth power of a length.

        Least bending alone has branch points where K̄ < 0 (Gemmer et al., doi:10.1209/0295-5075/114/24003). This energy is infinite there.

        Parameters
        ----------
        evenness
            The length, against the square root of the area.
        """
        other, areas = copy.copy(self), self.mesh.at(self.drawing, np.zeros(len(self.mesh.angles.ends))).areas
        other.pattern = self.pattern.copied()
        other.uneven = other.pattern.unevenness(self, areas, evenness)
        return other

    def on(self, drawing: FloatArray) -> Lagrangian:
        """Return the energy of another drawing (n, 3) without supports, whose curvature is not prescribed."""
        nowhere = np.zeros(0, np.int64)
        return Lagrangian(
            self.mesh, drawing, np.ones(len(drawing), bool), nowhere, Piecewise([ConstantCurvature(np.zeros(0))], nowhere), *self._posed[3:]
        )

    def over(self, drawing: FloatArray, side: float) -> Lagrangian:
        """Return the same problem over another drawing (n, 3), and the side to which domes rise, 1 or -1."""
        other = Lagrangian(self.mesh, drawing, *self._posed, pattern=self.pattern)
        other.side = side
        return other

    def vertices(self, unknowns: FloatArray) -> FloatArray:
        """Return the vertices (n, 3) for unknowns (u,)."""
        n = len(self.drawing)
        return self.drawing + unknowns[:n, None] * self.mesh.directions

    def volume(self, unknowns: FloatArray, areas: FloatArray) -> float:
        """Return the volume under the moves of the vertices along their directions, for unknowns (u,) and areas of faces (m,)."""
        return float(np.einsum("m,m->", unknowns[self.mesh.faces].mean(axis=1), areas))

    def moments(self, unknowns: FloatArray, areas: FloatArray) -> tuple[float, ...]:
        """Return the volume under the moves and its second moments, rounded: those of mirror twins have opposite signs."""
        centroids = self.drawing[self.mesh.faces].mean(axis=1)
        arms = centroids - np.average(centroids, axis=0, weights=areas)
        volumes = unknowns[self.mesh.faces].mean(axis=1) * areas
        second = np.einsum("m,mi,mj->ij", volumes, arms, arms)[np.triu_indices(3)]
        return tuple(np.round([volumes.sum(), *second], MOMENT_DIGITS).tolist())

    def at(self, unknowns: FloatArray) -> State:
        """Return energy and residuals for unknowns (u,)."""
        vertices = self.vertices(unknowns)
        operators = self.mesh.at(vertices, unknowns[len(self.drawing) :])
        T, A, H, K = self.curvatures(operators)
        folds = self.folds(unknowns)
        S = operators.tensors / operators.areas[:, None]
        uneven = float(np.einsum("me,e,me->", S, OCCURRENCES, self.uneven @ S))
        energy = float(operators.bending.sum() + 0.5 * (self._fold_weights @ folds**2 + self.kept @ unknowns**2)) + uneven
        by_tensor, by_area = self._spared
        energy += float(by_area @ operators.areas - np.einsum("me,me->", by_tensor, operators.tensors))
        return State(unknowns, operators, energy, A * self.law.residual(H, K), self.conditions.at(vertices))

    def curvatures(self, operators: ShapeOperators) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return the summed tensors (r, 6), areas, mean and Gaussian curvatures (r,) of the pairs of the equations."""
        averages = self.mesh.averages(operators)
        T, A = averages.tensors[self.rows], averages.areas[self.rows]
        return T, A, 0.5 * T @ TRACE / A, determinants(T) / A**2

    def folds(self, unknowns: FloatArray) -> FloatArray:
        """Return the folds of the crease edges (c,) less those that cost nothing [rad]."""
        return np.asarray(unknowns[self._fold_columns] @ [1.0, -1.0] - self.folded_as)

    def untilted(self, state: State) -> State:
        """Return a state that is not turned against the drawing where supports leave it free to turn."""
        n = len(self.drawing)
        moves = self.turns.taken_out(state.unknowns[:n])
        return state if np.array_equal(moves, state.unknowns[:n]) else self.at(np.concatenate([moves, state.unknowns[n:]]))

    def moved(self, state: State, step: FloatArray) -> State:
        """Return the state after a step of the free unknowns (q,)."""
        unknowns = state.unknowns.copy()
        unknowns[self.free] += step
        return self.at(unknowns)

    def gradient(self, state: State, multipliers: FloatArray, forces: FloatArray) -> FloatArray:
        """Return the derivatives of the Lagrangian by the free unknowns (q,) for multipliers (r + k,) and forces (c,) of conditions."""
        multipliers, pressed = np.split(multipliers, [len(self.rows)])
        own, onto = state.operators, self.mesh.incidence[self.rows].T
        bent, uneven, stretched = self._stresses(own)
        row_by_tensor, row_by_area, _ = self._laws(own)
        spared_by_tensor, spared_by_area = self._spared
        by_tensor = bent + uneven - spared_by_tensor + onto @ (multipliers[:, None] * row_by_tensor)
        by_area = onto @ (multipliers * row_by_area) - own.bending / own.areas - stretched + spared_by_area
        by_face = np.einsum("me,mek->mk", by_tensor, own.tensor_slopes)
        by_face[:, :3] += by_area[:, None] * own.area_slopes
        whole = self.fold_terms(state.unknowns)[0] + np.bincount(self.mesh.columns.ravel(), by_face.ravel(), self.mesh.unknowns)
        whole[: len(self.drawing)] += state.met.slopes.T @ forces
        np.add.at(whole, self.conditions.vertices, pressed[:, None] * state.met.place_slopes)
        return np.asarray(whole[self.free], dtype=np.float64)

    def _stresses(self, own: ShapeOperators) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the derivatives of bending and of unevenness by the tensors of faces (m, 6), and minus those of unevenness by areas."""
        S = own.tensors / own.areas[:, None]
        uneven = 2.0 * OCCURRENCES * (self.uneven @ S) / own.areas[:, None]
        return 2.0 * OCCURRENCES * S, uneven, np.einsum("me,me->m", uneven, S)

    def model(self, state: State, multipliers: FloatArray) -> Model:
        """Return the Lagrangian to second order for multipliers (r + k,)."""
        multipliers = multipliers[: len(self.rows)]
        own = state.operators.to_second_order()
        A, S = own.areas, own.tensors / own.areas[:, None]
        bent, uneven, stretched = self._stresses(own)
        spared_by_tensor, spared_by_area = self._spared
        by_tensor, by_area = bent + uneven - spared_by_tensor, -own.bending / A - stretched + spared_by_area
        slopes = np.concatenate([own.tensor_slopes, np.pad(own.area_slopes, ((0, 0), (0, 3)))[:, None]], axis=1)
        gradient = np.einsum("me,mek->mk", by_tensor, slopes[:, :6]) + by_area[:, None] * slopes[:, 6]
        bending_curvature = _second(np.diag(2.0 * OCCURRENCES) / A[:, None, None], -bent / A[:, None], 2.0 * own.bending / A**2)
        stretching = _second(np.zeros((len(A), 6, 6)), -uneven / A[:, None], 2.0 * stretched / A)
        convex = slopes.transpose(0, 2, 1) @ bending_curvature @ slopes

        row_by_tensor, row_by_area, row_curvature = self._laws(own)
        onto = self.mesh.incidence[self.rows].T
        weighed = multipliers[:, None] * row_by_tensor
        curved = own.second_derivatives(by_tensor + onto @ weighed, by_area + onto @ (multipliers * row_by_area))
        curved += slopes.transpose(0, 2, 1) @ stretching @ slopes
        shape_slopes = (slopes[:, :6] - S[..., None] * slopes[:, 6:]) / A[:, None, None]
        rows = np.column_stack([row_by_tensor, row_by_area])
        parts = Parts(gradient, convex, curved, slopes, shape_slopes, rows, multipliers[:, None, None] * row_curvature)
        return self.pattern.model(self, state, parts)

    def _laws(self, operators: ShapeOperators) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the derivatives of the residuals by summed tensors (r, 6) and areas (r,), and the second ones by both (r, 7, 7)."""
        T, A, H, K = self.curvatures(operators)
        f, (by_H, by_K) = self.law.residual(H, K), self.law.first_derivatives(H, K)
        slope = (by_K / A)[:, None] * (T @ DETERMINANT)
        curvature = _second((by_K / A)[:, None, None] * DETERMINANT, -slope / A[:, None], 2.0 * by_K * K / A)
        second = self.law.second_derivatives(H, K)
        if second is not None:
            HH, HK, KK = second
            of_H = np.column_stack([np.tile(0.5 * TRACE, (len(A), 1)), -H]) / A[:, None]
            of_K = np.column_stack([T @ DETERMINANT / A[:, None], -2.0 * A * K]) / (A**2)[:, None]
            pull_H, pull_K = HH * of_H.T + HK * of_K.T, HK * of_H.T + KK * of_K.T
            curvature += A[:, None, None] * (of_H[:, :, None] * pull_H.T[:, None] + of_K[:, :, None] * pull_K.T[:, None])
        return 0.5 * by_H[:, None] * TRACE + slope, f - by_H * H - 2.0 * by_K * K, curvature

    def area_derivative(self, state: State, weights: FloatArray) -> FloatArray:
        """Return the derivative (q,) of the areas of the cells of the equations times weights (r,)."""
        at_faces = self.mesh.incidence[self.rows].T @ weights
        whole = np.bincount(self.mesh.faces.ravel(), (at_faces[:, None] * state.operators.area_slopes).ravel(), self.mesh.unknowns)
        return np.asarray(whole[self.free], dtype=np.float64)

    def fold_terms(self, unknowns: FloatArray) -> tuple[FloatArray, IntArray, FloatArray]:
        """Return the derivative by all unknowns (u,) of folding and of what is kept, and columns (c, 2) and weights (c,) of folds."""
        pull = (self._fold_weights * self.folds(unknowns))[:, None] * [1.0, -1.0]
        gradient = np.bincount(self._fold_columns.ravel(), pull.ravel(), len(unknowns)) + self.kept * unknowns
        return gradient, self._fold_columns, self._fold_weights


def _second(tensors: FloatArray, mixed: FloatArray, areas: FloatArray) -> FloatArray:
    """Return second derivatives (k, 7, 7) by six entries of a tensor and an area from their blocks (k, 6, 6), (k, 6) and (k,)."""
    whole = np.empty((len(areas), 7, 7))
    whole[:, :6, :6], whole[:, 6, 6] = tensors, areas
    whole[:, :6, 6] = whole[:, 6, :6] = mixed
    return whole
