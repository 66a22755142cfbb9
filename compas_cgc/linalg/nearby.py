"""GMRES, preconditioned by the factors of a similar matrix."""

from __future__ import annotations

import math
from typing import Callable
from typing import Optional
from typing import Union

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import LinearOperator

from ..discrete.arrays import FloatArray

__all__ = ["nearly_solved"]

MAX_ITERATIONS = 9  # iterations; they take about half as long as factorising a matrix of 1e5 unknowns
MIN_ITERATIONS = 3  # iterations before slow convergence may end the solve


def nearly_solved(
    matrix: Union[sparse.csr_matrix, LinearOperator],
    precondition: Callable[[FloatArray], FloatArray],
    right: FloatArray,
    tolerance: float,
    rounds: int = MAX_ITERATIONS,
) -> Optional[FloatArray]:
    """Return the solution of a linear system by GMRES to a loose tolerance; None if that takes too many iterations.

    Parameters
    ----------
    matrix
        ``(n, n)``, not necessarily symmetric.
    precondition
        Returns the solution ``(n,)`` with a similar matrix for a right-hand side ``(n,)``.
    right
        ``(n,)`` right-hand side.
    tolerance
        Norm of the residual relative to that of the right-hand side.
    rounds
        Maximum number of iterations.

    Returns
    -------
    (n,) float64 or None

    References
    ----------
    Saad and Schultz, doi:10.1137/0907058; Eisenstat and Walker, doi:10.1137/0917003.

    Examples
    --------
    >>> matrix = sparse.csr_matrix([[2.0, 0.1], [0.0, 2.0]])
    >>> found = nearly_solved(matrix, lambda v: v / 2.0, np.array([2.0, 2.0]), 1e-12)
    >>> bool(np.allclose(matrix @ found, 2.0))
    True
    """
    size = float(np.linalg.norm(right))
    if not size > 0.0 or not math.isfinite(size):
        return np.zeros_like(right) if size == 0.0 else None
    basis, moves = [right / size], []
    H, wanted = np.zeros((rounds + 1, rounds)), np.zeros(rounds + 1)
    wanted[0] = size
    for k in range(rounds):
        moves.append(precondition(basis[k]))
        image = matrix @ moves[k]
        for i, own in enumerate(basis):
            H[i, k] = float(own @ image)
            image -= H[i, k] * own
        H[k + 1, k] = float(np.linalg.norm(image))
        if not np.isfinite(H[: k + 2, k]).all():
            return None
        weights = np.linalg.lstsq(H[: k + 2, : k + 1], wanted[: k + 2], rcond=None)[0]
        left = float(np.linalg.norm(H[: k + 2, : k + 1] @ weights - wanted[: k + 2])) / size
        if left <= tolerance:
            return np.asarray(sum(weight * move for weight, move in zip(weights, moves)))
        if k + 1 >= MIN_ITERATIONS and left > tolerance ** ((k + 1) / (1.5 * rounds)):
            return None
        basis.append(image / H[k + 1, k])
    return None
