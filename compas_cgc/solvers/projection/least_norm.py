"""Moves that fulfil the linear equations: the cheapest one, and the projection onto those that change nothing."""

from __future__ import annotations

import math
from typing import Callable
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete.arrays import FloatArray
from ...linalg import SingularMatrixError
from ...linalg import factorise
from ...linalg.work import rights
from ...linalg.work import spend
from ..constants import FACTORS
from ..constants import KRYLOV
from .found_curvature import CommonPart
from .metric import Metric
from .vectors import dot
from .vectors import norm

__all__ = ["Cheapest", "LeastNorm", "Preconditioner", "Rows"]

# rounds of conjugate gradients before a preconditioner is made [rounds]; half and twice as many move surfaces by 1e-8 of the size at most
FEW = 15
EARLY = 5  # rounds whose rate predicts the number of rounds [rounds]; a third of FEW, and half and twice as many give the same surfaces
# predicted rounds over FEW from which a preconditioner is made at once; a rough prediction, and half and twice it give the same surfaces
FAR = 1.5
SOFT = 1e-6  # regularisation of the preconditioner relative to the scale of the system; keeps it definite, and six digits of it
LEAST = 1e-8  # scale of an equation relative to the largest; rows of slivers would dominate otherwise

Preconditioner = Callable[[FloatArray], FloatArray]


class Cheapest(NamedTuple):
    """The cheapest move that fulfils linear equations, as far as it does."""

    move: FloatArray  # (q,) W⁻¹ Jᵀ y [L]
    multipliers: FloatArray  # (k,) y, without what unknown K take up
    residual: FloatArray  # (k,) what is left of the right side [rad]


class Rows:
    """A matrix by its products."""

    def __init__(self, shape: tuple[int, int], product: Callable[[FloatArray], FloatArray]):
        self.shape, self._product = shape, product

    def __matmul__(self, vector: FloatArray) -> FloatArray:
        return self._product(vector)


class LeastNorm:
    r"""Solves ``J dz = b`` by the moves that are cheapest in a metric, for several right sides.

    The cheapest move is :math:`W^{-1} J^T y` with :math:`(J W^{-1} J^T) y = b`. The metric is of
    fourth order and K of second, so that matrix is of order zero, and conjugate gradients take about as many
    rounds on a fine mesh as on a coarse one. Where K <= 0 it has small eigenvalues along
    the asymptotic directions; there it is preconditioned by the same system for moves along
    the normals only, one unknown per vertex, solved as regularised normal equations.

    Parameters
    ----------
    J
        ``(k, q)`` derivatives of the equations along the free directions [rad/L].
    metric
        The metric.
    across
        Returns ``(q, p)`` unit moves across the surface, one per vertex; asked for them only
        where a preconditioner is made.
    preconditioner
        That of the step before.
    common
        Part of the right sides that unknown K take up, in which the equations are not asked.
    """

    def __init__(
        self,
        J: sparse.csr_matrix,
        metric: Metric,
        across: Callable[[], sparse.csr_matrix],
        preconditioner: Optional[Preconditioner] = None,
        common: Optional[CommonPart] = None,
    ):
        self.metric, self._sparse = metric, J
        transposed = J.T
        self.J: Rows = J if common is None else Rows(J.shape, lambda v: common.removed(J @ v))
        self.transposed: Rows = transposed if common is None else Rows(transposed.shape, lambda y: transposed @ common.transposed(y))
        self._common, self._across = common, across
        self.preconditioner = preconditioner
        self._own = False
        self._rows = _row_scaling(J)

    def cheapest(self, right: FloatArray, tolerance: float, floor: float = 0.0) -> Cheapest:
        """Return the cheapest move that fulfils ``J dz = right``.

        Parameters
        ----------
        right
            ``(k,)`` right side [rad].
        tolerance
            Residual of the linear system, as a part of the right side.
        floor
            Residual per equation that is small enough in any case [rad].
        """
        start = Cheapest(np.zeros(self.J.shape[1]), np.zeros(len(right)), right)
        if not self._sparse.data.any():
            return start
        goal = max(tolerance * norm(right), floor * math.sqrt(len(right)))
        part = EARLY / (FAR * FEW)
        hope = math.inf if self.preconditioner is not None else norm(right) ** (1.0 - part) * goal**part
        found = self._close(start, goal, KRYLOV if self._own else FEW, hope)
        if norm(found.residual) > goal and not self._own:
            try:
                self.preconditioner = self._normal_moves()
                self._own = True
            except SingularMatrixError:
                pass  # Faces without area, or unknown K that meet every equation: what is found without it has to do.
            found = self._close(found, goal, KRYLOV if self._own else FEW - EARLY)
        return found if self._common is None else found._replace(multipliers=self._common.transposed(found.multipliers))

    def without_effect(self, gradient: FloatArray, tolerance: float) -> tuple[FloatArray, FloatArray]:
        """Return the part of the move ``W⁻¹ gradient`` that ``J`` does not see (q,), and the multipliers that do so (k,)."""
        move = self.metric.solve(gradient)
        found = self.cheapest(self.J @ move, tolerance)
        return move - found.move, found.multipliers

    def _solve(self, y: FloatArray) -> FloatArray:
        spend(rights(1, self.transposed.shape[0]))
        return self.metric.solve(self.transposed @ y)

    def _normal_moves(self) -> Preconditioner:
        """Return the inverse of the system for moves along the normals, by Woodbury's formula."""
        across = self._across()
        normal = (self._sparse @ across).tocsr()
        transposed = normal.T.tocsr()
        probe = np.cos(np.arange(self.J.shape[0], dtype=np.float64))
        felt = dot(probe, self.J @ self._solve(probe))
        if not felt > 0.0:
            raise SingularMatrixError("no equation depends on a move")
        weight = dot(probe, probe) / (SOFT * felt)
        spend(rights(FACTORS, self.transposed.shape[0]))
        points = np.empty((across.shape[1], 3))
        points[across.indices] = self.metric.points
        factor = factorise(self.metric.reduced(across) + weight * (transposed @ normal), symmetric=True, points=points, refine=False)
        return lambda v: weight * (v - normal @ factor.solve(weight * (transposed @ v)))

    def _close(self, start: Cheapest, goal: float, most: int, hope: float = math.inf) -> Cheapest:
        """Return the best that conjugate gradients find; the move is added up alongside, as to form it from y at the end costs a solve."""
        precondition = self.preconditioner or self._rows
        move, y, residual = start
        least, best = norm(residual), start
        direction: Optional[FloatArray] = None
        before = 0.0
        for done in range(most):
            if least <= goal or (done == EARLY and least > hope):
                break
            z = precondition(residual)
            product = dot(residual, z)
            direction = z if direction is None else z + product / before * direction
            turn = self._solve(direction)
            image = self.J @ turn
            curvature = dot(direction, image)
            if not (curvature > 0.0 and product > 0.0):
                break
            length = product / curvature
            move, y, residual = move + length * turn, y + length * direction, residual - length * image
            before = product
            if norm(residual) < least:
                least, best = norm(residual), Cheapest(move, y, residual)
        return best


def _row_scaling(J: sparse.csr_matrix) -> Preconditioner:
    """Return the division by the squared lengths of the rows, none taken for much smaller than the largest."""
    squares = np.bincount(np.repeat(np.arange(J.shape[0]), np.diff(J.indptr)), J.data**2, J.shape[0])
    scale = np.maximum(squares, LEAST * squares.max(initial=0.0))
    return lambda v: v / scale
