"""The least-norm step: the cheapest move that fulfils the linear equations."""

from __future__ import annotations

import math
from typing import Callable
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse

from ..discrete.arrays import FloatArray
from .factor import SingularMatrixError
from .factor import factorise
from .metric import Metric
from .vectors import dot
from .vectors import norm

__all__ = ["Preconditioner", "Step", "least_norm"]

FEW = 15  # rounds after which a preconditioner is made, or made anew
MOST = 60  # rounds after which the step is taken as it is
SOFT = 1e-6  # regularisation of the preconditioner, against the scale of the system
LEAST = 1e-8  # of an equation's own scale, against the largest

Preconditioner = Callable[[FloatArray], FloatArray]


class Step(NamedTuple):
    """A move in the free directions."""

    move: FloatArray  # (q,) [L]
    preconditioner: Optional[Preconditioner]  # for the next step, should this one have needed it


def least_norm(
    J: sparse.csr_matrix,
    right: FloatArray,
    metric: Metric,
    across: sparse.csr_matrix,
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
        ``(q, p)`` unit moves across the surface, one per vertex.
    tolerance
        Residual of the linear system, as a part of the right side.
    floor
        Residual per equation that is small enough in any case [rad].
    preconditioner
        That of the step before.
    """
    scale = np.asarray(J.multiply(J).sum(axis=1)).ravel()
    largest = float(scale.max(initial=0.0))
    if largest == 0.0:
        return Step(np.zeros(J.shape[1]), preconditioner)
    scale = np.maximum(scale, LEAST * largest)
    transposed = J.T.tocsr()

    def apply(y: FloatArray) -> FloatArray:
        return J @ metric.solve(transposed @ y)

    goal = max(tolerance * norm(right), floor * math.sqrt(len(right)))
    y, done = _conjugate_gradients(apply, right, np.zeros(len(right)), preconditioner or (lambda v: v / scale), goal, FEW)
    if not done:
        try:
            preconditioner = _normal_moves(J, metric, across, apply)
        except SingularMatrixError:
            # Faces without area: what was found without it has to do.
            return Step(metric.solve(transposed @ y), None)
        y, _ = _conjugate_gradients(apply, right, y, preconditioner, goal, MOST)
    return Step(metric.solve(transposed @ y), preconditioner)


def _normal_moves(J: sparse.csr_matrix, metric: Metric, across: sparse.csr_matrix, apply: Preconditioner) -> Preconditioner:
    """Return the inverse of the system for moves along the normals, by Woodbury's formula."""
    normal = (J @ across).tocsr()
    transposed = normal.T.tocsr()
    probe = np.cos(np.arange(J.shape[0], dtype=np.float64))
    weight = dot(probe, probe) / (SOFT * dot(probe, apply(probe)))
    factor = factorise(metric.reduced(across) + weight * (transposed @ normal))
    return lambda v: weight * (v - normal @ factor.solve(weight * (transposed @ v)))


def _conjugate_gradients(
    apply: Callable[[FloatArray], FloatArray],
    right: FloatArray,
    start: FloatArray,
    precondition: Preconditioner,
    goal: float,
    most: int,
) -> tuple[FloatArray, bool]:
    """Return the best solution found, and whether its residual fell below the goal."""
    y = start
    residual = right - apply(y) if y.any() else right
    least, best = norm(residual), y
    direction: Optional[FloatArray] = None
    before = 0.0
    for _ in range(most):
        if least <= goal:
            break
        z = precondition(residual)
        product = dot(residual, z)
        direction = z if direction is None else z + product / before * direction
        image = apply(direction)
        curvature = dot(direction, image)
        if not (curvature > 0.0 and product > 0.0):
            break
        y = y + product / curvature * direction
        residual = residual - product / curvature * image
        before = product
        if norm(residual) < least:
            least, best = norm(residual), y
    return best, least <= goal
