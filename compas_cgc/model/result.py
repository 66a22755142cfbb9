"""What a solve returns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING
from typing import NamedTuple

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray

if TYPE_CHECKING:
    from ..datastructures import CGCMesh

__all__ = ["STATUSES", "History", "Solution", "SolveResult", "SolveState", "stops"]

STATUSES = ("converged", "step_limit", "stalled", "diverged", "infeasible", "cancelled")


class History(NamedTuple):
    """One entry per step taken."""

    energy: FloatArray  # (k,) energy Φ after the step, about the centroid [L]
    error_norm: FloatArray  # (k,) κ of Eq. 30 [1/L^2]
    max_error: FloatArray  # (k,) largest |K - K̄| [1/L^2]
    step_length: FloatArray  # (k,) μ taken [L^3]
    trials: IntArray  # (k,) step lengths tried
    accepted: np.ndarray  # (k,) bool: the step passed Eqs. 28 and 29

    @classmethod
    def from_rows(cls, rows: list[tuple]) -> History:
        """Return the history of a list of rows, one per step."""
        columns = list(zip(*rows)) if rows else [()] * 6
        kinds = (np.float64,) * 4 + (np.int64, np.bool_)
        return cls(*(np.array(column, dtype=kind) for column, kind in zip(columns, kinds)))

    def to_dict(self) -> dict:
        """Return plain lists by name."""
        return {name: getattr(self, name).tolist() for name in self._fields}


class SolveState(NamedTuple):
    """What a callback sees after every step."""

    step: int  # number of this step, from 1
    steps: int  # most steps that will be taken
    energy: float  # Φ about the centroid [L]
    error_norm: float  # κ of Eq. 30 [1/L^2]
    max_error: float  # largest |K - K̄| [1/L^2]
    step_length: float  # μ taken [L^3]
    trials: int  # step lengths tried
    seconds: float  # since the start
    vertices: FloatArray  # (n, 3) present coordinates with any dummy vertices at the end [L]


def stops(callback: Callable[[SolveState], object], state: SolveState) -> bool:
    """Show a state to a callback and tell whether it asks to cancel: by True, or by ``StopIteration``."""
    try:
        return callback(state) is True
    except StopIteration:
        return True


class Solution(NamedTuple):
    """What a solver on arrays returns."""

    vertices: FloatArray  # (n, 3) [L]
    status: str  # one of STATUSES
    message: str  # one sentence
    iterations: int  # steps taken
    seconds: float  # wall time
    max_error: float  # largest |K - K̄| where K is asked [1/L^2]
    history: History
    method: str = ""  # the method that was used


@dataclass(frozen=True)
class SolveResult:
    """What :func:`compas_cgc.solve` returns.

    Parameters
    ----------
    mesh
        A copy of the input with the new coordinates, without dummy vertices.
    status
        ``converged``, ``step_limit``, ``stalled``, ``diverged``, ``infeasible`` or ``cancelled``.
    message
        One sentence that says how it ended, and what to do if it did not end well.
    iterations
        Steps taken.
    seconds
        Wall time of the solve.
    max_error
        Largest |K - K̄| over the vertices where K is asked for [1/L^2].
    history
        Energy, error norm, max error, step length and trials of every step.
    method
        The method that was used.
    """

    mesh: CGCMesh
    status: str
    message: str
    iterations: int
    seconds: float
    max_error: float
    history: History
    method: str

    @property
    def converged(self) -> bool:
        """Whether every curvature asked for was reached to the tolerance."""
        return self.status == "converged"
