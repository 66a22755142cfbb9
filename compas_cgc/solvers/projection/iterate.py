"""A shape on the way, and what it lacks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...discrete.arrays import FloatArray
from ...model.tolerances import ROUNDING
from ..constants import CONVERGED
from .vectors import norm

__all__ = ["SMALLEST_AREA", "Point"]

SMALLEST_AREA = 1e-100  # area that keeps the error of a vertex without area finite [L²]; any value far below those of cells


class Point(NamedTuple):
    """A shape with what is missing from what is asked of it."""

    vertices: FloatArray  # (n, 3)
    residual: FloatArray  # (k + g,) defect_i - K̄_i A_i at the vertices with an equation [rad], and what goals lack
    areas: FloatArray  # (k,) A_i
    gap: FloatArray  # (n,) distance from fulfilling the constraints
    merit: float  # norm of residuals and gaps, which the line search makes smaller

    @property
    def error(self) -> FloatArray:
        """|K - K̄| at the vertices with an equation (k,)."""
        return np.abs(self.residual[: len(self.areas)]) / np.maximum(self.areas, SMALLEST_AREA)

    @property
    def lacking(self) -> FloatArray:
        """What goals of the whole surface lack, as a part of its size (g,)."""
        return self.residual[len(self.areas) :]

    @property
    def max_error(self) -> float:
        """Largest |K - K̄|."""
        return float(self.error.max(initial=0.0))

    @property
    def error_norm(self) -> float:
        """Norm of K - K̄, κ of Eq. 30."""
        return norm(self.error)

    @property
    def badness(self) -> tuple[bool, float]:
        """What to compare shapes by: constraints before curvature."""
        return bool((self.gap > ROUNDING).any() or (np.abs(self.lacking) > CONVERGED).any()), self.error_norm

    def fulfils(self, goal: float, floor: FloatArray) -> bool:
        """Return whether everything is reached: |K - K̄| to the goal, or residuals to their floor (k + g,) [rad]."""
        reached = np.abs(self.residual) <= np.maximum(goal * np.append(self.areas, 0.0 * self.lacking), floor)
        return bool(reached.all()) and not self.badness[0]
