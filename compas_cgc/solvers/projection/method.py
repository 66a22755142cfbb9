"""The projection as a method."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..method import Method
from .settings import ProjectionSettings

if TYPE_CHECKING:
    from ...model.problem import CGCProblem
    from ...model.recorder import Callback
    from ...model.result import Solution

__all__ = ["METHOD"]


def _solve(problem: CGCProblem, settings: ProjectionSettings, callback: Callback) -> Solution:
    # Loaded when it is used: who asks for help should not wait for compiled kernels.
    from .projector import project

    return project(problem, settings=settings, callback=callback)


METHOD = Method(
    "projection",
    "The fairest surface for K̄ of any sign, with free edges, creases and constraints.",
    ProjectionSettings,
    _solve,
    goals="any",
    any_sign=True,
)
