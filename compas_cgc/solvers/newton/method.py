"""Registration of Newton's method along the normals as a method."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..method import Method
from .settings import NewtonSettings

if TYPE_CHECKING:
    from ...model.problem import CGCProblem
    from ...model.recorder import Callback
    from ...model.result import Solution

__all__ = ["METHOD"]


def _solve(problem: CGCProblem, settings: NewtonSettings, callback: Callback) -> Solution:
    # Loaded when it is used: who asks for help should not wait for compiled kernels.
    from ..carried import solve_carried
    from .normal_newton import newton

    return solve_carried(newton, problem, settings, callback)


METHOD = Method(
    "newton",
    "One unknown per vertex along its normal, for K̄ > 0 over fixed edges or from an initial guess near the target, with fixed "
    "creases (the fastest method on large meshes).",
    NewtonSettings,
    _solve,
    goals="whole",
    has_dummies=True,
)
