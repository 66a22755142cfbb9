"""Registration of the method by mid-edge normals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..method import Method
from .settings import PolishSettings

if TYPE_CHECKING:
    from ...model.problem import CGCProblem
    from ...model.recorder import Callback
    from ...model.result import Solution

__all__ = ["METHOD"]


def _solve(problem: CGCProblem, settings: PolishSettings, callback: Callback) -> Solution:
    # Loaded when it is used, so that help texts do not wait for compiled kernels.
    from ...model.goals.binding import unknown_constants
    from .goal_seeking import seek
    from .polisher import polish

    if unknown_constants(problem):
        return seek(problem, settings, callback)
    return polish(problem, settings=settings, callback=callback)


METHOD = Method(
    "bending",
    "The surface that bends and folds least, for K̄ of any sign, with goals for heights and free edges over their drawn lines (it "
    "converges under refinement, also at creases and free edges).",
    PolishSettings,
    _solve,
    goals="places",
    any_sign=True,
    any_law=True,
)
