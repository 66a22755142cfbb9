"""The optimality system of the fairest surface: what its derivatives say at the solution."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.jacobian import CurvatureEquations
from .iterate import Point
from .system import System

__all__ = ["Optimality", "optimality"]

STEP = 1e-8  # of the difference quotients of first derivatives, in the local frame
PRECISE = 1e-10  # residual of the multipliers


class Optimality(NamedTuple):
    r"""The factorised matrix :math:`\begin{pmatrix} H & J^T \\ J & 0 \end{pmatrix}` at a shape.

    H is the second derivative of the Lagrangian in the free directions, that of the mixed areas included.
    """

    system: System
    multipliers: FloatArray  # (l,) of the leading equations
    basis: sparse.csr_matrix  # (3c, q) free directions
    factor: object  # of the matrix (q + l, q + l)
    areas: sparse.csr_matrix  # (k, 3c) derivatives of the mixed areas
    point: Point

    def correction(self, equations: CurvatureEquations) -> FloatArray:
        """Return Newton's step (n, 3) from the shape to the fairest one near to it."""
        system, point = self.system, self.point
        energy = system.fairness.energy(point.vertices)[1]
        J = system.jacobian(point, equations)
        slope = self.basis.T @ (energy + J.T @ system.spread(self.multipliers)[: len(system.rows)])
        right = -np.concatenate([slope, point.residual[system.leading]])
        solution = self.factor.solve(right)  # type: ignore[attr-defined]
        return system.full(self.basis @ solution[: self.basis.shape[1]])

    def moves(self, group: IntArray) -> FloatArray:
        """Return the derivative (n, 3) of the shape by the K of some equations, by their positions among the k rows."""
        system, leading = self.system, self.system.leading
        own = np.zeros(len(system.rows))
        own[group] = 1.0
        weights = system.spread(self.multipliers)[: len(system.rows)] * own
        gradient = self.basis.T @ (self.areas.T @ weights)
        asked = np.append(own * self.point.areas, np.zeros(len(system.goals.equations)))[leading]
        solution = self.factor.solve(np.concatenate([gradient, asked]))  # type: ignore[attr-defined]
        return system.full(self.basis @ solution[: self.basis.shape[1]])


def optimality(system: System, point: Point, equations: CurvatureEquations) -> Optimality:
    """Return the optimality system at a shape that is the fairest one for given K.

    Goals of the whole surface are let go: what they push with stays, as weights of theirs.
    """
    linear = system.linearised(point, equations)
    energy = system.fairness.energy(point.vertices)[1]
    multipliers = linear.solver.without_effect(-linear.reduced(energy), PRECISE)[1]
    basis = linear.solver.metric.basis
    count = 3 * len(system.columns)
    free = sparse.identity(count, format="csr") if basis is None else basis
    weights = system.spread(multipliers)
    held = system.without_goals(keep_contact=True)
    second = system.fairness.second_derivative() + _second_derivative(system, equations, point, weights)
    rows = held.leading[held.leading < len(system.rows)]
    J = (system.jacobian(point, equations)[rows] @ free).tocsr()
    H = free.T @ second @ free
    matrix = sparse.bmat([[H, J.T], [J, None]], format="csc")
    unit = system.equations(np.ones_like(equations.targets))
    areas = system.equations(np.zeros_like(equations.targets)).jacobian(point.vertices) - unit.jacobian(point.vertices)
    return Optimality(held, multipliers[: len(rows)], free.tocsr(), splu(matrix), areas.tocsr(), point)


def _second_derivative(system: System, equations: CurvatureEquations, point: Point, weights: FloatArray) -> sparse.csr_matrix:
    """Return the second derivative (3c, 3c) of the equations weighed by (k + g,), by differences of their first ones.

    Only vertices of one face have to do with each other, so vertices without a common neighbour are moved together.
    """
    columns, k = system.columns, len(system.rows)
    x = point.vertices
    position = np.full(len(x), -1)
    position[columns] = np.arange(len(columns))

    def gradient(vertices: FloatArray) -> FloatArray:
        total = (equations.jacobian(vertices).T @ weights[:k]).reshape(-1, 3)
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
