"""The last digits of K, by moves across the surface: linear equations for one unknown per vertex, solved directly."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import suppress
from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete import vertex_normals
from ...discrete.arrays import EPS
from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from ...linalg import LinearSolver
from ...linalg import SingularMatrixError
from ...linalg import linear_solver
from ..constants import MAX_STEPS
from .found_curvature import FoundCurvature
from .gauss_newton import FINISH
from .gauss_newton import SLOW
from .gauss_newton import Taken
from .gauss_newton import descend
from .iterate import Point
from .linearised import Kept
from .system import System
from .vectors import dot
from .vectors import norm

__all__ = ["Closing", "along", "closed_across", "is_bound_by_k_alone"]

# weights of the metric relative to the equations; the smallest that leaves the matrix positive definite is used, rounding decides
SOFT = (1e-9, 1e-8, 1e-7, 1e-5)
LEAST = 1e-2  # relative residual of the linear systems; steps converge by a factor of 100, as the directions are fixed
# steps across in which residuals may grow [steps]; where K < 0 the last ones oscillate, and half and twice as many give the same surfaces
MEMORY = 3


class Closing(System):
    """A system near a solution, whose linear equations are met by moves along the normals of one shape.

    The least such move comes from a direct factorisation of ``W + w Jᵀ J`` for one unknown per vertex, a matrix as sparse as the
    bending energy W; refinement makes up for the weight w.

    Parameters
    ----------
    system
        One that nothing but K binds.
    vertices
        ``(n, 3)`` the shape.
    """

    def __init__(self, system: System, vertices: FloatArray):
        self.__dict__.update(system.__dict__)
        self._normals = vertex_normals(vertices, system.faces)[system.columns]
        self._W = self._metric_across()
        self._solver = linear_solver(len(self._normals), symmetric=True, points=system.fairness.points[::3], refine=False)

    def step(
        self, point: Point, equations: CurvatureEquations, tolerance: float, kept: Optional[Kept]
    ) -> tuple[FloatArray, Optional[Kept]]:
        """Return the least step across (n, 3), no numbers where moves across hardly do anything for the equations."""
        J, right = along(self._normals, self.jacobian(point, equations)), -point.residual
        heights, missing = self._least(J, right, max(tolerance, LEAST))
        if norm(missing) > SLOW * norm(right):
            heights = np.full_like(heights, np.nan)
        return self.full((heights[:, None] * self._normals).ravel()), kept

    def _metric_across(self) -> sparse.csr_matrix:
        """Return the metric of moves along the normals (c, c)."""
        plan, height, N = self.fairness.plan, self.fairness.height, self._normals @ self.fairness.axes.T
        rows = np.repeat(np.arange(len(N)), np.diff(plan.indptr))
        one, two, up = (np.ascontiguousarray(part) for part in N.T)
        flat = one[rows] * one[plan.indices] + two[rows] * two[plan.indices]
        data = plan.data * flat + height.data * up[rows] * up[plan.indices]
        return sparse.csr_matrix((data, plan.indices, plan.indptr), shape=plan.shape)

    def _factors(self, squares: sparse.csr_matrix, balance: float) -> tuple[float, LinearSolver]:
        """Return a weight of the squared equations (c, c), and factors of the metric with them."""
        for soft in SOFT[:-1]:
            try:
                return balance / soft, self._solver.factorise((self._W + balance / soft * squares).tocsr())
            except SingularMatrixError:
                # Of a million vertices, rounding leaves the metric no say beside such a weight.
                continue
        return balance / SOFT[-1], self._solver.factorise((self._W + balance / SOFT[-1] * squares).tocsr())

    def _least(self, J: sparse.csr_matrix, right: FloatArray, tolerance: float) -> tuple[FloatArray, FloatArray]:
        """Return the least (c,) of ``½ aᵀ W a`` with ``J a = right``, and what is missing (k,).

        Conjugate residuals, as factors of the metric and the weighted equations only nearly solve both.
        """
        W, transposed = self._W, J.T.tocsr()
        squares = (transposed @ J).tocsr()
        balance = float(W.diagonal().sum() / squares.diagonal().sum())  # of the metric's size to that of the squared equations
        weight, solver = self._factors(squares, balance)
        scale = float(np.sqrt(balance * self.fairness.height.diagonal().mean()))
        heights, pull, missing = np.zeros(len(self._normals)), np.zeros(len(self._normals)), right
        goal = max(tolerance * norm(right), EPS * np.sqrt(len(right)))
        first = scale * norm(right)
        kept: list[tuple] = []
        for _ in range(MAX_STEPS):
            step = solver.solve(pull + weight * (transposed @ missing))
            more = weight * (missing - J @ step)
            direction = [step, W @ step - transposed @ more, J @ step]
            for before in kept:
                part = (dot(direction[1], before[1]) + scale**2 * dot(direction[2], before[2])) / before[3]
                direction = [own - part * other for own, other in zip(direction, before)]
            move, pulled, done = direction
            square = dot(pulled, pulled) + scale**2 * dot(done, done)
            if not square > 0.0:
                break
            length = (dot(pull, pulled) + scale**2 * dot(missing, done)) / square
            heights, pull, missing = heights + length * move, pull - length * pulled, missing - length * done
            kept.append((*direction, square))
            if np.hypot(norm(pull), scale * norm(missing)) <= tolerance * first and norm(missing) <= goal:
                break
        return heights, missing


def closed_across(system: System, equations: CurvatureEquations, near: Point) -> Generator[Taken, None, Point]:
    """Take steps across a shape to the last digits of K, where moves that do so are tiny; return where they lead."""
    here = near
    if not is_bound_by_k_alone(system, equations):
        return here
    with suppress(SingularMatrixError):
        for taken in descend(Closing(system, near.vertices), equations, near, patience=FINISH, memory=MEMORY):
            if taken.length < 1.0:
                break
            here = system.at(taken.vertices, equations)
            yield taken
    return here


def is_bound_by_k_alone(system: System, equations: CurvatureEquations) -> bool:
    """Return whether nothing but a K that is given is asked of a system."""
    return system.asks_for_k_alone and not isinstance(equations, FoundCurvature)


def along(directions: FloatArray, J: sparse.csr_matrix) -> sparse.csr_matrix:
    """Return derivatives by moves along one direction (c, 3) per vertex (k, c), of those by coordinates (k, 3c)."""
    # The three coordinates of a vertex stand beside each other.
    vertex = J.indices[::3] // 3
    values = np.einsum("ij,ij->i", J.data.reshape(-1, 3), directions[vertex])
    return sparse.csr_matrix((values, vertex, J.indptr // 3), shape=(J.shape[0], len(directions)))
