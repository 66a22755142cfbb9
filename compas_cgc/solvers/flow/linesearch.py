"""The step length of Section 4: Armijo's condition (Eq. 28) and a bound on K (Eq. 29)."""

from __future__ import annotations

from typing import Callable
from typing import NamedTuple

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.evaluation import Measurement

__all__ = ["Step", "armijo_line_search"]


class Step(NamedTuple):
    """The step that a line search ended with."""

    vertices: FloatArray  # (n, 3)
    measurement: Measurement  # of these vertices
    length: float  # μ
    trials: int  # step lengths tried
    accepted: bool  # the step fulfils Eqs. 28 and 29


def armijo_line_search(
    measure: Callable[[FloatArray], Measurement],
    vertices: FloatArray,
    direction: FloatArray,
    energy: float,
    slope: float,
    curvature_bound: FloatArray,
    *,
    mu0: float,
    tau: float,
    xi: float,
    q: int,
) -> Step:
    """Return the longest of the steps μ0, τ μ0, τ² μ0, ... that fulfils Eqs. 28 and 29.

    When none of the ``q + 1`` does, the shortest is returned, not accepted.

    Parameters
    ----------
    measure
        Curvature and energy of a shape.
    vertices
        ``(n, 3)`` present shape.
    direction
        ``(n, 3)`` move for μ = 1.
    energy
        Φ of the present shape.
    slope
        <∇Φ, direction>.
    curvature_bound
        ``(n,)`` largest K allowed, infinite where there is no bound.
    """
    mu = mu0
    for trial in range(1, q + 2):
        moved = vertices + mu * direction
        there = measure(moved)
        enough = there.energy <= energy + xi * mu * slope
        if enough and bool(np.all(there.curvature <= curvature_bound)):
            return Step(moved, there, mu, trial, True)
        if trial <= q:
            mu *= tau
    return Step(moved, there, mu, q + 1, False)
