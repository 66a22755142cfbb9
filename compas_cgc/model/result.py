"""History, state and solution of a solve as arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from .laws import Law
from .problem import CGCProblem
from .verdict import Verdict

__all__ = ["FAILED", "STATUSES", "Branch", "History", "Solution", "SolveState"]

STATUSES = ("converged", "step_limit", "stalled", "diverged", "infeasible", "cancelled")
FAILED = ("diverged", "infeasible")  # statuses without a surface


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
        """Return the history of rows, one per step."""
        columns = list(zip(*rows)) if rows else [()] * 6
        energy, error_norm, max_error, step_length = (np.array(column, dtype=np.float64) for column in columns[:4])
        return cls(energy, error_norm, max_error, step_length, np.array(columns[4], dtype=np.int64), np.array(columns[5], dtype=np.bool_))

    def to_dict(self) -> dict:
        """Return a dict of lists."""
        return {name: getattr(self, name).tolist() for name in self._fields}


class SolveState(NamedTuple):
    """State of a solve after a step, passed to callbacks."""

    step: int  # number of this step, from 1
    steps: int  # largest number of steps
    energy: float  # Φ about the centroid [L]
    error_norm: float  # κ of Eq. 30 [1/L^2]
    max_error: float  # largest |K - K̄| [1/L^2]
    step_length: float  # μ taken [L^3]
    trials: int  # step lengths tried
    seconds: float  # seconds since the start
    vertices: FloatArray  # (n, 3) coordinates, dummy vertices last [L]


class Branch(NamedTuple):
    """One of several surfaces with the same curvature over the same supports."""

    vertices: FloatArray  # (n, 3) [L]
    energy: float  # bending and folding, dimensionless
    fair: bool  # by its verdict
    twin_of: Optional[int] = None  # number of the branch with the same energy that it mirrors


class Solution(NamedTuple):
    """Result of a solver, as arrays."""

    vertices: FloatArray  # (n, 3) [L]
    status: str  # one of STATUSES
    message: str  # one sentence
    iterations: int  # steps taken
    seconds: float  # wall time
    max_error: float  # largest |K - K̄| at internal vertices [1/L^2]
    history: History
    method: str = ""  # name of the method
    measure: str = "defect"  # measure of K in max_error
    targets: Optional[FloatArray] = None  # (n,) targets including solved unknowns, None if all were given [1/L^2]
    verdict: Optional[Verdict] = None  # of the surface, None if not judged yet
    faces: Optional[IntArray] = None  # (m, 3) if edges were flipped, None if they are those of the problem
    branches: tuple[Branch, ...] = ()  # that were found, the one returned first
    laws: Optional[Mapping[int, Law]] = None  # by region including solved unknowns, None if all were given
    evenness: float = 0.0  # length over which curvature was made to vary evenly, relative to the square root of the area

    @property
    def is_fair(self) -> bool:
        """Whether the surface was judged, and is fair."""
        return self.verdict is not None and self.verdict.fair

    def with_found(self, problem: CGCProblem) -> CGCProblem:
        """Return a problem with the unknown targets and constants of laws that were found for it."""
        found = problem if self.targets is None else problem.with_targets(self.targets)
        return found if self.laws is None else found.with_laws(self.laws)
