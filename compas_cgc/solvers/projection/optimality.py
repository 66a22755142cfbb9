"""The optimality system of the fairest surface: what its derivatives say at the solution."""

from __future__ import annotations

from copy import copy
from typing import Callable
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.jacobian import CurvatureEquations
from ...linalg import SingularMatrixError
from ...linalg.ordering import elimination_order
from ..constants import CONVERGED
from .iterate import Point
from .system import System

__all__ = ["Optimality", "optimality"]

STEP = 1e-8  # step of difference quotients of exact gradients [L]; the root of the rounding error
PIVOT = 1e-3  # pivot relative to the largest entry of its column, above which it is kept; preserves the ordering at a loss of three digits


class Optimality(NamedTuple):
    r"""The factorised matrix :math:`\begin{pmatrix} H & J^T \\ J & 0 \end{pmatrix}` at a shape.

    H is the second derivative of the Lagrangian in the free directions, that of the mixed areas included.
    """

    system: System
    multipliers: FloatArray  # (l,) of the leading equations
    basis: Optional[sparse.csr_matrix]  # (3c, q) free directions, None for all
    factor: Callable[[FloatArray], FloatArray]  # the inverse of the matrix (q + l, q + l)
    point: Point

    def correction(self, point: Point, equations: CurvatureEquations, multipliers: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return Newton's step (n, 3) from a shape to the fairest one near to it, and that of the multipliers (l,)."""
        system = self.system
        energy = system.fairness.energy(point.vertices)[1]
        J = system.jacobian(point, equations)
        slope = energy + J.T @ system.spread(multipliers)[: len(system.rows)]
        return self._solved(slope, point.residual[system.leading])

    def moves(self, equations: CurvatureEquations, change: FloatArray) -> FloatArray:
        """Return how the shape moves (n, 3), to first order, with a change of the K of the equations (k,)."""
        system, leading = self.system, self.system.leading
        unit, none = copy(equations), copy(equations)
        unit.targets, none.targets = np.ones_like(equations.targets), np.zeros_like(equations.targets)
        areas = none.jacobian(self.point.vertices) - unit.jacobian(self.point.vertices)
        gradient = areas.T @ (system.spread(self.multipliers)[: len(system.rows)] * change)
        asked = np.append(change * self.point.areas, np.zeros(len(system.goals.equations)))[leading]
        return self._solved(-gradient, -asked)[0]

    def _solved(self, gradient: FloatArray, residual: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the move (n, 3) and the multipliers (l,) that take a gradient (3c,) and residuals (l,) away."""
        free = gradient if self.basis is None else self.basis.T @ gradient
        solution = self.factor(-np.concatenate([free, residual]))
        move = solution[: len(free)]
        return self.system.full(move if self.basis is None else self.basis @ move), solution[len(free) :]


def optimality(system: System, point: Point, equations: CurvatureEquations, multipliers: Optional[FloatArray] = None) -> Optimality:
    """Return the optimality system at a shape that is the fairest one for given K, with its multipliers (l,) where they are known.

    Goals of the whole surface are let go: what they push with stays, as weights of theirs.

    Raises
    ------
    SingularMatrixError
        If there are many such shapes side by side.
    """
    if multipliers is None:
        linear = system.linearised(point, equations)
        energy = system.fairness.energy(point.vertices)[1]
        multipliers = linear.solver.without_effect(-linear.reduced(energy), CONVERGED)[1]
    freedoms = system.places.freedoms(point.vertices)
    free = freedoms.basis
    weights = system.spread(multipliers)
    held = system.without_goals(keep_contact=True)
    second = system.fairness.second_derivative() + equations.second_derivative(point.vertices, weights[: len(system.rows)])
    if system.goals.equations:
        second = second + _second_derivative_of_goals(system, point, weights)
    rows = held.leading[held.leading < len(system.rows)]
    J = system.jacobian(point, equations)[rows]
    if free is not None:
        second, J = free.T @ second @ free, J @ free
    matrix = sparse.bmat([[second, J.T], [J, None]], format="csr")
    order = _elimination_order(system, np.concatenate([freedoms.owner, system.rows[rows]]))
    return Optimality(held, multipliers[: len(rows)], free, _factorised(matrix, order), point)


def _elimination_order(system: System, owner: IntArray) -> IntArray:
    """Return an order of unknowns that belong to vertices: all of one together, its multiplier last, so that no pivot is zero."""
    rank = np.full(len(system.places.start), len(system.columns))
    rank[system.columns[elimination_order(system.fairness.plan, system.fairness.points[::3])]] = np.arange(len(system.columns))
    return np.argsort(rank[owner], kind="stable")


def _factorised(matrix: sparse.csr_matrix, order: IntArray) -> Callable[[FloatArray], FloatArray]:
    """Return the inverse of a symmetric matrix, by factors in an order of elimination."""
    if not np.isfinite(matrix.data).all():  # SuperLU would leave its memory.
        raise SingularMatrixError("the second derivatives are not finite")
    places = np.argsort(order)
    try:
        factors = splu(_reordered(matrix, places), permc_spec="NATURAL", diag_pivot_thresh=PIVOT, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise SingularMatrixError(str(error)) from None
    return lambda right: factors.solve(right[order])[places]


def _reordered(matrix: sparse.csr_matrix, places: IntArray) -> sparse.csc_matrix:
    """Return a matrix with its unknowns at other places."""
    entries = matrix.tocoo()
    return sparse.csc_matrix((entries.data, (places[entries.row], places[entries.col])), shape=matrix.shape)


def _second_derivative_of_goals(system: System, point: Point, weights: FloatArray) -> sparse.csr_matrix:
    """Return the second derivative (3c, 3c) of the goals of the whole surface weighed by (k + g,), by differences of their first ones.

    Only vertices of one face have to do with each other, so vertices without a common neighbour are moved together.
    """
    columns, k = system.columns, len(system.rows)
    x = point.vertices
    position = np.full(len(x), -1)
    position[columns] = np.arange(len(columns))

    def gradient(vertices: FloatArray) -> FloatArray:
        total = np.zeros((len(columns), 3))
        for own, weight in zip(system.goals.equations, weights[k:]):
            total = total + weight / system.size**own.power * own.gradient(vertices)[columns]
        return total

    neighbours = _neighbours(system.faces, len(x))
    colour = _colours(neighbours, columns)
    pairs = neighbours[columns][:, columns].tocoo()
    rows_of, from_ = pairs.row, pairs.col
    entries, at, by = [], [], []
    for number in range(int(colour.max(initial=-1)) + 1):
        moved = columns[colour == number]
        mine = colour[from_] == number
        for axis in range(3):
            ahead, behind = x.copy(), x.copy()
            ahead[moved, axis] += STEP
            behind[moved, axis] -= STEP
            change = (gradient(ahead) - gradient(behind)) / (2.0 * STEP)
            entries.append(change[rows_of[mine]].ravel())
            at.append((3 * rows_of[mine][:, None] + np.arange(3)).ravel())
            by.append(np.repeat(3 * from_[mine] + axis, 3))
    size = 3 * len(columns)
    if not entries:
        return sparse.csr_matrix((size, size))
    matrix = sparse.csr_matrix((np.concatenate(entries), (np.concatenate(at), np.concatenate(by))), shape=(size, size))
    return (0.5 * (matrix + matrix.T)).tocsr()


def _neighbours(faces: IntArray, n: int) -> sparse.csr_matrix:
    """Return which vertices share a face (n, n), themselves included."""
    corner = sparse.csr_matrix((np.ones(faces.size), (np.repeat(np.arange(len(faces)), 3), faces.ravel())), shape=(len(faces), n))
    return (corner.T @ corner).tocsr()


def _colours(neighbours: sparse.csr_matrix, columns: IntArray) -> IntArray:
    """Return a colour of every movable vertex (c,), such that no two of one colour have a neighbour in common."""
    near = (neighbours @ neighbours)[columns][:, columns].tocsr()
    colour = np.full(len(columns), -1)
    for vertex in range(len(columns)):
        taken = set(colour[near.indices[near.indptr[vertex] : near.indptr[vertex + 1]]].tolist())
        colour[vertex] = next(number for number in range(len(taken) + 1) if number not in taken)
    return colour
