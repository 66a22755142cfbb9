"""Surfaces of piecewise constant K near a design, by moves of its vertices along its normals."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from functools import partial
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse

from ..discrete import edge_faces
from ..discrete import vertex_areas
from ..discrete import vertex_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.jacobian import CurvatureEquations
from ..discrete.space_form import exact_equations
from ..linalg import LinearSolver
from ..linalg import SingularMatrixError
from ..linalg import factorise
from ..meshing.regions import inner_labels
from ..solvers.constants import GROUND
from ..solvers.projection.metric import bending_matrix
from ..solvers.projection.metric import slope_jumps
from .panelling import Panelling

__all__ = ["LinearMoves", "NormalMoves", "Sensitivities", "Weights"]

PENALTY = 1e4  # of squared deviations of K, against squared moves, in lengths of the design; multipliers remove what it leaves
FOLD_LENGTH = 1.6  # in widths of a panel, times the angle of a fold: what counts as much as a distance of that size
CORRECTIONS = 2  # of the multipliers
SHORTEST = 0.02  # part of a step of Newton's method


class Weights(NamedTuple):
    """What moves cost, besides their squares."""

    smoothness: float = 2.4  # length over which bending outweighs distance, in edges: on shorter waves meshes do not show K
    crease_stiffness: float = 1.0  # of seams, as in ProjectionSettings


class LinearMoves(NamedTuple):
    """Moves for any K of the panels, to first order: ``constant + by_panel @ K``."""

    constant: FloatArray  # (c,) [L]
    by_panel: FloatArray  # (c, p) [L^3]

    def at(self, K: FloatArray) -> FloatArray:
        """Return the moves (c,) for the K (p,) of the panels [L]."""
        return self.constant + self.by_panel @ K

    def through(self, moves: FloatArray, K: FloatArray) -> LinearMoves:
        """Return the model whose moves are given ones (c,) for K (p,)."""
        return LinearMoves(moves - self.by_panel @ K, self.by_panel)

    def of(self, criteria: Callable[[FloatArray], FloatArray]) -> LinearMoves:
        """Return linear criteria of the moves, to first order."""
        return LinearMoves(criteria(self.constant), criteria(self.by_panel))


class NormalMoves:
    r"""The surfaces ``x + w n`` over a panelled design, with K of every panel constant in the exact measure.

    Moves along normals are distances from the design, on the rim and on seams too, and nothing can slide along it unseen. Criteria C w
    are the moves and the changes of the folds at seams, times the width of a panel, and times their importance. Of all surfaces with
    given K the one of least energy :math:`\frac12 w^T (C^T M C + \beta Q) w` is taken, with masses M of the criteria and the bending
    energy Q of the moves. A linearisation is one sparse positive definite system, with K held by a penalty and multipliers.

    Parameters
    ----------
    panelling
        The design and its panels.
    fixed
        ``(n,)`` vertices that do not move.
    weights
        What moves cost.
    groups
        ``(p,)`` group of every panel with the same K. Groups then count as panels: K and moulds are those of groups.
    importance
        ``(n,)`` factors by which distances and folds at vertices are multiplied. Default: 1.

    References
    ----------
    Nocedal and Wright, *Numerical Optimization*, chapter 17 (augmented Lagrangian), doi:10.1007/978-0-387-40065-5.
    """

    def __init__(
        self,
        panelling: Panelling,
        fixed: Mask,
        weights: Optional[Weights] = None,
        groups: Optional[IntArray] = None,
        importance: Optional[FloatArray] = None,
    ):
        weights = weights or Weights()
        V, F = panelling.vertices, panelling.faces
        n = len(V)
        self.vertices, self.faces = V, F
        self.normals = vertex_normals(V, F)
        self.columns = np.flatnonzero(~fixed)
        inside = inner_labels(n, F, panelling.panels)
        self.rows = np.flatnonzero((inside >= 0) & ~fixed)
        self.groups = np.arange(panelling.panel_count) if groups is None else groups
        self.panel_of_row = self.groups[inside[self.rows]]
        self.panels = int(self.groups.max(initial=-1)) + 1
        self._equations = exact_equations(CurvatureEquations(F, np.zeros(n), self.rows, self.columns), "exact")
        areas = vertex_areas(V, F)
        self.size = float(np.sqrt(areas.sum()))
        self.importance = np.ones(n) if importance is None else importance
        self.mass = areas[self.columns] / areas.sum()
        seams = np.zeros(n, bool)
        seams[panelling.seams.ravel()] = True
        bending = bending_matrix(V, F, seams, weights.crease_stiffness)[self.columns][:, self.columns]
        self.smoothing_length = float(weights.smoothness * self.size / np.sqrt(n))
        self._bending = (self.smoothing_length**4 / areas.sum() * bending).tocsr()
        seam_edges, jumps = slope_jumps(V, F, np.flatnonzero(_on_seams(F, panelling.panels)))
        width = FOLD_LENGTH * self.size / np.sqrt(panelling.panel_count)
        self.panel_width = float(self.size / np.sqrt(panelling.panel_count))
        factors = np.concatenate([self.importance[self.columns], width * self.importance[seam_edges].mean(axis=1)])
        self._criteria = (sparse.diags(factors) @ sparse.vstack([sparse.identity(len(self.columns)), jumps[:, self.columns]])).tocsr()
        own = np.linalg.norm(V[seam_edges[:, 1]] - V[seam_edges[:, 0]], axis=1)
        shares = [self.mass / self.mass.sum(), own / max(own.sum(), 1e-300)]
        self.criteria_mass = np.concatenate(shares) / 2.0
        self._closeness = 2.0 * self.criteria_mass
        # Largest K of a panel of the design, times the area.
        self.bend = float(np.abs(self.mean_curvatures(np.zeros(len(self.columns)))).max(initial=0.0)) * self.size**2

    def stressing(self, weights: FloatArray) -> NormalMoves:
        """Return the same surfaces where criteria count by other weights (d,) in the energy."""
        other = copy(self)
        other._closeness = 2.0 * self.criteria_mass * weights
        return other

    def shape(self, moves: FloatArray) -> FloatArray:
        """Return the vertices (n, 3) for moves (c,) [L]."""
        shape = self.vertices.copy()
        shape[self.columns] += moves[:, None] * self.normals[self.columns]
        return shape

    def criteria(self, moves: FloatArray) -> FloatArray:
        """Return the distances and the changes of folds times the width of a panel (d,) or (d, r) for moves (c,) or (c, r) [L].

        Both are multiplied by their importance.
        """
        return self._criteria @ moves

    def distances(self, moves: FloatArray) -> FloatArray:
        """Return the distances times their importance (c,), the first of the criteria [L]."""
        return self.importance[self.columns] * moves

    def criteria_transposed(self, weights: FloatArray) -> FloatArray:
        """Return the derivatives (c, r) of sums of criteria with weights (d, r) by the moves."""
        return self._criteria.T @ weights

    def mean_curvatures(self, moves: FloatArray) -> FloatArray:
        """Return the mean K of every panel (p,) [1/L^2]."""
        defects, areas = self._measured(moves, np.zeros(self.panels))
        sums = (np.bincount(self.panel_of_row, values, self.panels) for values in (defects, areas))
        total, area = sums
        return total / np.where(area > 0.0, area, 1.0)

    def panel_areas(self) -> FloatArray:
        """Return the weight of every panel (p,), the area around its vertices [L^2]."""
        _, areas = self._measured(np.zeros(len(self.columns)), np.zeros(self.panels))
        return np.bincount(self.panel_of_row, areas, self.panels).astype(np.float64)

    def error(self, moves: FloatArray, K: FloatArray) -> float:
        """Return the largest deviation from the K (p,) of the panels, times the area of the design."""
        residual, areas = self._measured(moves, K)
        return float(np.abs(residual / areas).max(initial=0.0)) * self.size**2

    def newton(self, moves: FloatArray, K: FloatArray, steps: int) -> FloatArray:
        """Return the moves (c,) after steps to the K (p,) of the panels, each by the change of least energy.

        All steps use the factors of the first. A step that would increase the deviations from K is halved.
        """
        system = self._linearised(moves, K)
        residual = self._measured(moves, K)[0]
        for _ in range(steps):
            change = system.solved(residual[:, None])[:, 0]
            length = 1.0
            while length > SHORTEST:
                there = self._measured(moves - length * change, K)[0]
                if np.linalg.norm(there) < np.linalg.norm(residual):
                    break
                length /= 2.0
            else:
                break
            moves, residual = moves - length * change, there
        return moves

    def sensitivities(self, moves: FloatArray, K: FloatArray) -> Sensitivities:
        """Return the derivatives of the moves by the K of the panels, about moves (c,) and the K (p,) of the panels."""
        return Sensitivities(self._linearised(moves, K), self.panel_of_row, self.panels, moves, K)

    def _measured(self, moves: FloatArray, K: FloatArray) -> tuple[FloatArray, FloatArray]:
        self._equations.targets = np.zeros(len(self.vertices))
        self._equations.targets[self.rows] = K[self.panel_of_row]
        return self._equations.measure(self.shape(moves))

    def _linearised(self, moves: FloatArray, K: FloatArray) -> _Linearised:
        residual, areas = self._measured(moves, K)
        jacobian = self._equations.jacobian(self.shape(moves), self.normals[self.columns])
        penalties = PENALTY * self.size**4 / areas
        matrix = (
            self._criteria.T @ sparse.diags(self._closeness) @ self._criteria
            + self._bending
            + jacobian.T @ sparse.diags(penalties) @ jacobian
        )
        solver = partial(factorise, symmetric=True, points=self.vertices[self.columns], refine=False)
        try:
            factor = solver(matrix.tocsr())
        except SingularMatrixError:
            # Beside cells that have almost no area all other stiffness is a rounding error.
            factor = solver((matrix + GROUND * sparse.diags(matrix.diagonal())).tocsr())
        return _Linearised(factor, jacobian, residual, areas, penalties)


class _Linearised(NamedTuple):
    factor: LinearSolver
    jacobian: sparse.csr_matrix  # (k, c)
    residual: FloatArray  # (k,)
    areas: FloatArray  # (k,)
    penalties: FloatArray  # (k,)

    def solved(self, right: FloatArray) -> FloatArray:
        """Return the moves (c, r) of least energy whose products with the Jacobian are right sides (k, r)."""
        found = np.zeros((self.jacobian.shape[1], right.shape[1]))
        for _ in range(CORRECTIONS):
            missing = right - self.jacobian @ found
            found = found + self.factor.solve(self.jacobian.T @ (self.penalties[:, None] * missing))
        return found

    def adjoint(self, weights: FloatArray) -> FloatArray:
        """Return the transpose of :meth:`solved` times weights (c, r): (k, r)."""
        found = np.zeros((self.jacobian.shape[0], weights.shape[1]))
        for _ in range(CORRECTIONS):
            missing = weights - self.jacobian.T @ found
            found = found + self.penalties[:, None] * (self.jacobian @ self.factor.solve(missing))
        return found


class Sensitivities(NamedTuple):
    """Derivatives of the moves by the K of the panels, behind one factorisation."""

    system: _Linearised
    panel_of_row: IntArray  # (k,)
    panels: int
    moves: FloatArray  # (c,) [L]
    K: FloatArray  # (p,) [1/L^2]

    def linear(self, groups: Optional[IntArray] = None) -> LinearMoves:
        """Return the moves to first order, by panel or by groups (p,) of panels with one K; one substitution for each."""
        of_row = self.panel_of_row if groups is None else groups[self.panel_of_row]
        count = self.panels if groups is None else int(groups.max()) + 1
        right = np.zeros((len(of_row), count + 1))
        right[np.arange(len(of_row)), of_row] = self.system.areas
        right[:, -1] = self.system.jacobian @ self.moves - self.system.residual
        found = self.system.solved(right)
        own = self.K if groups is None else _of_groups(self.K, groups, count)
        return LinearMoves(found[:, -1] - found[:, :-1] @ own, found[:, :-1])

    def constant(self) -> FloatArray:
        """Return the moves (c,) for K = 0 in all panels, to first order [L]."""
        right = self.system.jacobian @ self.moves - self.system.residual - self.system.areas * self.K[self.panel_of_row]
        return self.system.solved(right[:, None])[:, 0]

    def forward(self, K: FloatArray) -> FloatArray:
        """Return the moves (c,) by K (p,), to first order [L]."""
        return self.system.solved((self.system.areas * K[self.panel_of_row])[:, None])[:, 0]

    def adjoint(self, weights: FloatArray) -> FloatArray:
        """Return the derivatives (p, r) of sums of moves with weights (c, r) by the K of every panel; one substitution for each sum."""
        by_row = self.system.areas[:, None] * self.system.adjoint(weights)
        gathered = sparse.csr_matrix((np.ones(len(by_row)), (self.panel_of_row, np.arange(len(by_row)))), shape=(self.panels, len(by_row)))
        return gathered @ by_row


def _on_seams(faces: IntArray, panels: IntArray) -> Mask:
    """Mark the inner edges between two panels, among those of edge_faces with two faces."""
    edges = edge_faces(faces)
    inner = edges[edges[:, 3] >= 0]
    return panels[inner[:, 2]] != panels[inner[:, 3]]


def _of_groups(K: FloatArray, groups: IntArray, count: int) -> FloatArray:
    own = np.zeros(count)
    own[groups] = K
    return own
