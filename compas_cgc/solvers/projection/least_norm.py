"""The least-norm step: the cheapest move that fulfils the linear equations."""

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
from .metric import Metric
from .vectors import dot
from .vectors import norm

__all__ = ["Preconditioner", "Step", "least_norm"]

FEW = 15  # rounds after which a preconditioner is made, or made anew
EARLY = 5  # rounds after which their pace tells that far more than a few will be needed
FAR = 1.5  # how many times more
MOST = 60  # rounds after which the step is taken as it is
SOFT = 1e-6  # regularisation of the preconditioner, against the scale of the system
LEAST = 1e-8  # of an equation's own scale, against the largest

Preconditioner = Callable[[FloatArray], FloatArray]


class Step(NamedTuple):
    """A move in the free directions."""

    move: FloatArray  # (q,) [L]
    preconditioner: Optional[Preconditioner]  # for the next step, should this one have needed it


class _Partial(NamedTuple):
    """A move that does not yet fulfil the equations."""

    move: FloatArray  # (q,) [L]
    residual: FloatArray  # (k,) what is left of the right side [rad]


def least_norm(
    J: sparse.csr_matrix,
    right: FloatArray,
    metric: Metric,
    across: Callable[[], sparse.csr_matrix],
    tolerance: float,
    floor: float,
    preconditioner: Optional[Preconditioner] = None,
) -> Step:
    r"""Return the solution of ``J dz = right`` that is cheapest in the metric.

    It is :math:`W^{-1} J^T y` with :math:`(J W^{-1} J^T) y = b`. The metric is of fourth order
    and K of second, so that matrix is of order zero, and conjugate gradients take about as many
    rounds on a fine mesh as on a coarse one. Where K <= 0 it has small eigenvalues along
    the asymptotic directions; there it is preconditioned by the same system for moves along
    the normals only, one unknown per vertex, solved as regularised normal equations.

    Parameters
    ----------
    J
        ``(k, q)`` derivatives of the equations along the free directions [rad/L].
    right
        ``(k,)`` right side [rad].
    metric
        The metric.
    across
        Returns ``(q, p)`` unit moves across the surface, one per vertex; asked for them only
        where a preconditioner is made.
    tolerance
        Residual of the linear system, as a part of the right side.
    floor
        Residual per equation that is small enough in any case [rad].
    preconditioner
        That of the step before.
    """
    if not J.data.any():
        return Step(np.zeros(J.shape[1]), preconditioner)
    transposed = J.T.tocsr()

    def cheapest(y: FloatArray) -> FloatArray:
        return metric.solve(transposed @ y)

    def close(start: _Partial, precondition: Preconditioner, most: int, hope: float = math.inf) -> _Partial:
        return _conjugate_gradients(J, cheapest, start, precondition, goal, most, hope)

    goal = max(tolerance * norm(right), floor * math.sqrt(len(right)))
    start = _Partial(np.zeros(J.shape[1]), right)
    rough, hope = preconditioner, math.inf
    if rough is None:
        part = EARLY / (FAR * FEW)
        rough, hope = _row_scaling(J), norm(right) ** (1.0 - part) * goal**part
    found = close(start, rough, FEW, hope)
    if not norm(found.residual) <= goal:
        try:
            preconditioner = _normal_moves(J, metric, across(), cheapest)
        except SingularMatrixError:
            # Faces without area: what is found without it has to do.
            return Step(close(found, rough, FEW - EARLY).move, None)
        found = close(found, preconditioner, MOST)
    return Step(found.move, preconditioner)


def _row_scaling(J: sparse.csr_matrix) -> Preconditioner:
    """Return the division by the squared lengths of the rows, none taken for much smaller than the largest."""
    squares = np.bincount(np.repeat(np.arange(J.shape[0]), np.diff(J.indptr)), J.data**2, J.shape[0])
    scale = np.maximum(squares, LEAST * squares.max())
    return lambda v: v / scale


def _normal_moves(J: sparse.csr_matrix, metric: Metric, across: sparse.csr_matrix, cheapest: Preconditioner) -> Preconditioner:
    """Return the inverse of the system for moves along the normals, by Woodbury's formula."""
    normal = (J @ across).tocsr()
    transposed = normal.T.tocsr()
    probe = np.cos(np.arange(J.shape[0], dtype=np.float64))
    weight = dot(probe, probe) / (SOFT * dot(probe, J @ cheapest(probe)))
    factor = factorise(metric.reduced(across) + weight * (transposed @ normal), symmetric=True, refine=False)
    return lambda v: weight * (v - normal @ factor.solve(weight * (transposed @ v)))


def _conjugate_gradients(
    J: sparse.csr_matrix,
    cheapest: Callable[[FloatArray], FloatArray],
    start: _Partial,
    precondition: Preconditioner,
    goal: float,
    most: int,
    hope: float,
) -> _Partial:
    """Return the best that is found. The move is added up alongside: to form it from y at the end would cost a solve."""
    move, residual = start
    least, best = norm(residual), start
    direction: Optional[FloatArray] = None
    before = 0.0
    for done in range(most):
        if least <= goal or (done == EARLY and least > hope):
            break
        z = precondition(residual)
        product = dot(residual, z)
        direction = z if direction is None else z + product / before * direction
        turn = cheapest(direction)
        image = J @ turn
        curvature = dot(direction, image)
        if not (curvature > 0.0 and product > 0.0):
            break
        move = move + product / curvature * turn
        residual = residual - product / curvature * image
        before = product
        if norm(residual) < least:
            least, best = norm(residual), _Partial(move, residual)
    return best
