"""Newton's method on the conditions of the fairest shape: to where rounding alone says which it is, whatever the way there."""

from __future__ import annotations

from typing import Optional

import numpy as np

from ...discrete.jacobian import CurvatureEquations
from ...linalg import SingularMatrixError
from ..constants import CONVERGED
from ..constants import ELSEWHERE
from ..constants import LOCAL_ROUNDING
from ..constants import MAX_STEPS
from .closing import is_bound_by_k_alone
from .gauss_newton import FULFILLED
from .optimality import Optimality
from .optimality import optimality
from .sequential import Reached
from .system import System

__all__ = ["brought_to_rest", "rests"]

MOST = 500  # movable vertices up to which the exact matrix is factorised [vertices]; bounds the time, which grows faster than linearly
FASTER = 0.3  # ratio of successive steps up to which the matrix is kept; beyond, a new one takes less time


def rests(system: System, equations: CurvatureEquations) -> bool:
    """Return whether shapes are few enough unknowns, bound by nothing but K, that a problem's are brought to rest."""
    return len(system.columns) <= MOST and is_bound_by_k_alone(system, equations)


def brought_to_rest(system: System, equations: CurvatureEquations, reached: Reached) -> Optional[Reached]:
    """Return the fairest shape near to one, to the last digits; None where there is none or it takes too long."""
    if not rests(system, equations):
        return None
    try:
        return _to_rest(optimality(system, reached.point, equations, reached.multipliers), equations, reached)
    except SingularMatrixError:
        return None


def _to_rest(solved: Optimality, equations: CurvatureEquations, reached: Reached) -> Optional[Reached]:
    """Return the fairest shape by Newton's steps with one matrix, that of a shape near to it; None where they do not lead there.

    References
    ----------
    Nocedal and Wright, *Numerical Optimization*, section 18.1, doi:10.1007/978-0-387-40065-5.
    """
    system = solved.system
    here, multipliers, longest = system.at(reached.point.vertices, equations), reached.multipliers, ELSEWHERE / FASTER
    for _ in range(MAX_STEPS):
        before = longest
        move, more = solved.correction(here, equations, multipliers)
        longest = float(np.abs(move).max(initial=0.0)) / system.size
        if not longest <= FASTER * before:
            longest = before
            break
        here, multipliers = system.at(here.vertices + move, equations), multipliers + more
        if longest <= LOCAL_ROUNDING:
            break
    return Reached(here, multipliers) if longest <= CONVERGED and system.missing(here, equations) <= FULFILLED else None
