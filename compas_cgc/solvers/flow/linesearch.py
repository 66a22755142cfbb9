"""Armijo line search (Eq. 28) with a bound on K (Eq. 29), as in Section 4."""

from __future__ import annotations

from typing import Callable
from typing import NamedTuple

import numpy as np

from ...discrete.arrays import PerVertex
from ...discrete.arrays import Vectors
from ...discrete.arrays import Vertices
from ...discrete.evaluation import Measurement

__all__ = ["Step", "armijo_line_search"]


class Step(NamedTuple):
    """The step that a line search ended with."""

    vertices: Vertices  # (n, 3)
    measurement: Measurement  # of these vertices
    length: float  # μ
    trials: int  # step lengths tried
    accepted: bool  # the step fulfils Eq. 28 and Eq. 29


def armijo_line_search(
    measure: Callable[[Vertices], Measurement],
    vertices: Vertices,
    direction: Vectors,
    energy: float,
    slope: float,
    curvature_bound: PerVertex,
    *,
    mu0: float,
    tau: float,
    xi: float,
    q: int,
) -> Step:
    """Return the longest of the steps μ0, τ μ0, τ² μ0, ... that fulfils Eq. 28 and Eq. 29.

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
    mu, trial = mu0, 1
    while True:
        moved = vertices + mu * direction
        there = measure(moved)
        enough = there.energy <= energy + xi * mu * slope
        if enough and bool(np.all(there.curvature <= curvature_bound)):
            return Step(moved, there, mu, trial, True)
        if trial > q:
            return Step(moved, there, mu, trial, False)
        mu, trial = mu * tau, trial + 1
