"""Registration of the flow as a method."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..method import Method
from .settings import FlowSettings

if TYPE_CHECKING:
    from ...model.problem import CGCProblem
    from ...model.recorder import Callback
    from ...model.result import Solution

__all__ = ["METHOD"]


def _solve(problem: CGCProblem, settings: FlowSettings, callback: Callback) -> Solution:
    # Loaded when it is used: who asks for help should not wait for compiled kernels.
    from ..carried import solve_carried
    from .finish import flow_and_finish

    return solve_carried(flow_and_finish, problem, settings, callback)


METHOD = Method(
    "flow",
    "The paper's filtered Gaussian curvature flow with crease strategies, for K̄ >= 0, refined by Newton's method.",
    FlowSettings,
    _solve,
    has_dummies=True,
)
