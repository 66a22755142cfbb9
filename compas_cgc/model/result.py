"""History, states and solution of a solve, on arrays."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from .verdict import Verdict

__all__ = ["STATUSES", "History", "Solution", "SolveState"]

STATUSES = ("converged", "step_limit", "stalled", "diverged", "infeasible", "cancelled")


class History(NamedTuple):
    """One entry per step taken."""

    energy: FloatArray  # (k,) energy Φ after the step, about the centroid [L]
    error_norm: FloatArray  # (k,) κ of Eq. 30 [1/L^2]
    max_error: FloatArray  # (k,) largest |K - K̄| [1/L^2]
    step_length: FloatArray  # (k,) μ taken [L^3]
    trials: IntArray  # (k,) step lengths tried
    accepted: np.ndarray  # (k,) bool: the step passed Eq. 28 and Eq. 29

    @classmethod
    def from_rows(cls, rows: list[tuple]) -> History:
        """Return the history of a list of rows, one per step."""
        columns = list(zip(*rows)) if rows else [()] * 6
        energy, error_norm, max_error, step_length = (np.array(column, dtype=np.float64) for column in columns[:4])
        return cls(energy, error_norm, max_error, step_length, np.array(columns[4], dtype=np.int64), np.array(columns[5], dtype=np.bool_))

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
    measure: str = "defect"  # of K, by which the errors are told
    targets: Optional[FloatArray] = None  # (n,) targets with those that were found, None where all were given [1/L^2]
    verdict: Optional[Verdict] = None  # of the surface, where it was judged on the way
    faces: Optional[IntArray] = None  # (m, 3) where edges were turned, None where they are those of the problem
