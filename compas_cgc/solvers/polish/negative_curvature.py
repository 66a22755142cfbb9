"""The direction along which the energy decreases although it is stationary."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete.arrays import FloatArray

__all__ = ["negative_curvature"]

ROUNDS = 40  # rounds of the Lanczos process [rounds]; bounds the time where curvature is hardly negative
STEADY = 0.1  # relative change of the curvature in a round below which the process ends; only the sign and a rough direction are used
# wave numbers of the first load along the axes [1/L]; irrational ratios, as a symmetric load finds symmetric directions only
WAVES = np.array([2.1, 3.7, 4.3])


def negative_curvature(
    responses: Callable[[FloatArray], FloatArray], hessian: sparse.csr_matrix, added: sparse.csr_matrix, places: FloatArray
) -> Optional[tuple[FloatArray, float]]:
    r"""Return a direction that meets the linearised equations and has negative second derivatives, and these; None if there is none.

    The second derivatives W are positive once a matrix A is added. With the inverse S of W + A among directions that meet the equations,
    the eigenvalues of S A are those of

    .. math:: A d = \mu (W + A) d,

    and above 1 exactly along directions of negative curvature. The Lanczos process finds the largest. Its first load has no symmetry and
    determines the sign of the direction, so that neither depends on rounding.

    Parameters
    ----------
    responses
        S times loads (s,).
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
    Saad, *Numerical Methods for Large Eigenvalue Problems*, sections 6.6 and 9.2.6, doi:10.1137/1.9781611970739.
    """
    load = np.zeros(hessian.shape[0])
    load[: len(places)] = np.cos(places @ WAVES + 1.0)
    T, before = np.zeros((ROUNDS, ROUNDS)), -np.inf
    directions, loads = np.zeros((2, ROUNDS, len(load)))  # biorthogonal
    direction = load
    for k in range(ROUNDS):
        response = responses(load)
        work = float(load @ response)
        if not 0.0 < work < np.inf:
            break
        directions[k], loads[k] = response / math.sqrt(work), load / math.sqrt(work)
        load = added @ directions[k]
        T[: k + 1, k] = T[k, : k + 1] = directions[: k + 1] @ load
        values, vectors = np.linalg.eigh(T[: k + 1, : k + 1])
        direction = (vectors[:, -1] * (1.0 if vectors[0, -1] > 0.0 else -1.0)) @ directions[: k + 1]
        gain, before = values[-1] - before, values[-1]
        if gain <= STEADY * (before - 1.0):
            break
        load = load - T[: k + 1, k] @ loads[: k + 1]
    direction = direction / np.abs(direction).max()
    curvature = float(direction @ (hessian @ direction))
    return (direction, curvature) if curvature < 0.0 else None
