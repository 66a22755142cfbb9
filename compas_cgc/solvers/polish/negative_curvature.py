"""The direction along which the energy decreases although it is stationary."""

from __future__ import annotations

from collections.abc import Callable
from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete.arrays import FloatArray

__all__ = ["negative_curvature"]

ROUNDS = 40  # rounds of the power iteration [rounds]; bounds the time where two directions are alike
STEADY = 0.1  # relative change of the curvature in a round below which the iteration ends; only the sign and a rough direction are used
# wave numbers of the first load along the axes [1/L]; irrational ratios, as a symmetric load finds symmetric directions only
WAVES = np.array([2.1, 3.7, 4.3])


def negative_curvature(
    responses: Callable[[FloatArray], FloatArray], hessian: sparse.csr_matrix, added: sparse.csr_matrix, places: FloatArray
) -> Optional[tuple[FloatArray, float]]:
    r"""Return a direction that meets the linearised equations and has negative second derivatives, and these; None if there is none.

    The second derivatives W are positive once a matrix A is added. The power iteration

    .. math:: \begin{pmatrix} W + A & J^T \\ J & -D \end{pmatrix} \begin{pmatrix} d_{k + 1} \\ \lambda \end{pmatrix}
              = \begin{pmatrix} A d_k \\ 0 \end{pmatrix}

    amplifies the directions along which W is negative, and no others. Its first load has no symmetry and determines the sign of the
    direction, so that neither depends on rounding.

    Parameters
    ----------
    responses
        Solution of the saddle system for loads (s,).
    hessian, added
        ``(s, s)`` W and A, with zeros for multipliers.
    places
        ``(k, 3)`` of the moves, which are the first unknowns, over the size.

    Returns
    -------
    tuple or None
        Direction (s,) whose largest move or angle is 1, and its second derivative.

    References
    ----------
    Nocedal and Wright, *Numerical Optimization*, section 3.4, doi:10.1007/978-0-387-40065-5.
    """
    direction, load, curvature = np.zeros(hessian.shape[0]), np.zeros(hessian.shape[0]), np.inf
    load[: len(places)] = np.cos(places @ WAVES + 1.0)
    for _ in range(ROUNDS):
        direction = responses(load)
        largest = float(np.abs(direction).max())
        if not np.isfinite(largest) or largest == 0.0:
            return None
        direction /= largest
        before, curvature = curvature, float(direction @ (hessian @ direction))
        if curvature < 0.0 and abs(curvature - before) <= STEADY * abs(curvature):
            break
        load = added @ direction
    return (direction, curvature) if curvature < 0.0 else None
