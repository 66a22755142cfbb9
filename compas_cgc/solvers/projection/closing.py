"""A system near a solution: linear equations solved directly, by moves across the surface, and as directly for moves along it."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete import vertex_normals
from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from ...linalg import LinearSolver
from ...linalg import SingularMatrixError
from ...linalg import factorise
from ...linalg import linear_solver
from .across import along
from .fairness import Fairness
from .iterate import Point
from .least_norm import Cheapest
from .least_norm import LeastNorm
from .linearised import Kept
from .linearised import Linearised
from .metric import Metric
from .system import System
from .vectors import dot
from .vectors import norm

__all__ = ["Closing"]

SOFT = (1e-9, 1e-8, 1e-7, 1e-5)  # weights of the metric against those of the equations: the first that leave the matrix positive definite
ROUNDS = 20  # of refinement
LEAST = 1e-2  # residual of the linear systems; steps converge by as much
HOPELESS = 0.9  # of the right side, left by a move that is not worth its step: along asymptotic lines K is mended by moves in the surface
TINY = 1e-300


class Closing(System):
    """A system whose linear equations are fulfilled by moves across one shape.

    What moves along the surface, in plan, change of K is undone across it. The least such move comes from a direct
    factorisation of ``W + w Jᵀ J`` for one unknown per vertex, a matrix as sparse as the bending energy; refinement makes
    up for the weight w.

    Parameters
    ----------
    system
        One that has a plan, and no constraints.
    vertices
        ``(n, 3)`` the shape.
    """

    def __init__(self, system: System, vertices: FloatArray):
        self.__dict__.update(system.__dict__)
        self._frame = _Frame(system.fairness, vertex_normals(vertices, system.faces)[system.columns])

    def linearised(self, point: Point, equations: CurvatureEquations, kept: Optional[Kept] = None) -> Linearised:
        """Return the equations about a shape."""
        J = self.jacobian(point, equations)
        return Linearised(_Direct(J, self._frame), None, -point.residual)


class _Factors(NamedTuple):
    source: sparse.csr_matrix  # (k, 3c) what they were made of
    J: sparse.csr_matrix  # (k, c) the same across
    transposed: sparse.csr_matrix
    weight: float
    balance: float  # of the metric's size to that of the squared equations
    solver: LinearSolver


class _Frame(Metric):
    """The metric, with directions across (c, 3) and factors for moves along and across."""

    def __init__(self, fairness: Fairness, across: FloatArray):
        self.plan, self.height, self.axes, self.basis = fairness.plan, fairness.height, fairness.axes, None
        self.points, self.normals = fairness.points, across
        self.stiffness = float(np.sqrt(fairness.height.diagonal().mean()))
        self._along: Optional[LinearSolver] = None
        self.factors: Optional[_Factors] = None
        self._solver = linear_solver(len(across), symmetric=True, points=self.points[::3], refine=False)

    def across(self, gradient: FloatArray) -> FloatArray:
        """Return the part across (c,) of a gradient (3c,)."""
        return np.einsum("ij,ij->i", gradient.reshape(-1, 3), self.normals)

    def lifted(self, heights: FloatArray) -> FloatArray:
        """Return the moves (3c,) by heights (c,) across."""
        return (heights[:, None] * self.normals).ravel()

    def along(self, gradient: FloatArray) -> FloatArray:
        """Return the moves in plan (3c,) that a gradient (3c,) makes."""
        if self._along is None:
            self._along = factorise(self.plan, symmetric=True, points=self.points[::3], refine=False)
        flat = self._along.solve(np.ascontiguousarray(gradient.reshape(-1, 3) @ self.axes[:2].T))
        return (flat @ self.axes[:2]).ravel()

    def renewed(self, J: sparse.csr_matrix) -> None:
        """Make factors for moves across that equations J (k, 3c) bind."""
        W = self._of_heights()
        across = along(self.normals, J)
        transposed = across.T.tocsr()
        squares = (transposed @ across).tocsr()
        balance = float(W.diagonal().sum() / squares.diagonal().sum())
        for soft in SOFT:
            weight = balance / soft
            try:
                self.factors = _Factors(J, across, transposed, weight, balance, self._solver.factorise((W + weight * squares).tocsr()))
                return
            except SingularMatrixError:
                # Of a million vertices, rounding leaves the metric no say beside such a weight.
                if soft == SOFT[-1]:
                    raise

    def of_heights(self, heights: FloatArray) -> FloatArray:
        """Return the metric's product with moves across (c,)."""
        return self.across(self.times(self.lifted(heights)))

    def _of_heights(self) -> sparse.csr_matrix:
        plan, height, N = self.plan, self.height, self.normals @ self.axes.T
        rows = np.repeat(np.arange(len(N)), np.diff(plan.indptr))
        one, two, up = (np.ascontiguousarray(part) for part in N.T)
        flat = one[rows] * one[plan.indices] + two[rows] * two[plan.indices]
        data = plan.data * flat + height.data * up[rows] * up[plan.indices]
        return sparse.csr_matrix((data, plan.indices, plan.indptr), shape=plan.shape)


class _Direct(LeastNorm):
    """Solves ``J dz = b`` by moves across, with factors of a matrix near by."""

    metric: _Frame

    def __init__(self, J: sparse.csr_matrix, frame: _Frame):
        self.J, self.transposed, self.metric = J, J.T.tocsr(), frame
        self.preconditioner = None

    def cheapest(self, right: FloatArray, tolerance: float, floor: float = 0.0) -> Cheapest:
        """Return the cheapest move across that fulfils ``J dz = right``, no numbers where moves across hardly do anything for it."""
        heights, multipliers, missing = self._least(np.zeros(self.J.shape[1] // 3), right, max(tolerance, LEAST), floor)
        if norm(missing) > HOPELESS * norm(right):
            heights = np.full_like(heights, np.nan)
        return Cheapest(self.metric.lifted(heights), multipliers, missing)

    def without_effect(self, gradient: FloatArray, tolerance: float) -> tuple[FloatArray, FloatArray]:
        """Return a move down a gradient (q,) that ``J`` does not see, and the multipliers that account for the rest (k,).

        Not the shortest in the metric, but one that depends on the gradient symmetrically, as conjugate gradients need.
        """
        frame = self.metric
        heights, multipliers, _ = self._least(frame.across(gradient), np.zeros(self.J.shape[0]), tolerance, 0.0)
        move = frame.along(gradient + self.transposed @ multipliers)
        undone = self._least(np.zeros_like(heights), -(self.J @ move), tolerance, 0.0)[0]
        return move + frame.lifted(heights + undone), -multipliers

    def _least(self, gradient: FloatArray, right: FloatArray, tolerance: float, floor: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the least (c,) of ``½ aᵀ W a - gradientᵀ a`` with ``J a = right``, the multipliers (k,) and what is missing (k,).

        Conjugate residuals, as factors of the metric and the weighted equations only nearly solve both.
        """
        frame = self.metric
        if frame.factors is None or frame.factors.source is not self.J:
            frame.renewed(self.J)
        assert frame.factors is not None
        _, J, transposed, weight, balance, solver = frame.factors
        scale = np.sqrt(balance) * frame.stiffness
        heights, multipliers = np.zeros_like(gradient), np.zeros_like(right)
        pull, missing = gradient, right
        goal = max(tolerance * norm(right), floor * np.sqrt(len(right)))
        first = np.hypot(norm(gradient), scale * norm(right))
        kept: list[tuple] = []
        for _ in range(ROUNDS):
            step = solver.solve(pull + weight * (transposed @ missing))
            more = weight * (missing - J @ step)
            pulled, done = frame.of_heights(step) - frame.across(self.transposed @ more), self.J @ frame.lifted(step)
            direction = [step, more, pulled, done]
            for before in kept:
                part = (dot(pulled, before[2]) + scale**2 * dot(done, before[3])) / before[4]
                direction = [own - part * other for own, other in zip(direction, before)]
                pulled, done = direction[2:]
            square = dot(pulled, pulled) + scale**2 * dot(done, done)
            if not square > 0.0:
                break
            length = (dot(pull, pulled) + scale**2 * dot(missing, done)) / square
            heights, multipliers = heights + length * direction[0], multipliers + length * direction[1]
            pull, missing = pull - length * pulled, missing - length * done
            kept.append((*direction, square))
            if np.hypot(norm(pull), scale * norm(missing)) <= tolerance * first and norm(missing) <= goal:
                break
        return heights, multipliers, missing
