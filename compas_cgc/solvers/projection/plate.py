"""The surface that bends least over its supports, with no K asked for."""

from __future__ import annotations

from ...discrete.arrays import FloatArray
from ...model.goals.binding import bind
from ...model.problem import CGCProblem
from .settings import ProjectionSettings
from .system import System

__all__ = ["relaxed"]


def relaxed(problem: CGCProblem) -> FloatArray:
    """Return the shape (n, 3) that bends least over the supports of a problem, whatever is drawn between them [L]."""
    local, frame = problem.local()
    system = System(local, ProjectionSettings(keep="plan"), bind(local, problem.goals))
    return frame.to_model(system.settled(system.fairness.relaxed()))
