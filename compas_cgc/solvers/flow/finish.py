"""The flow with its finish: it shapes the creases, Newton's method takes the regions between them to rounding."""

from __future__ import annotations

from dataclasses import replace
from typing import Any
from typing import Optional

import numpy as np

from ...model.problem import CGCProblem
from ...model.recorder import Callback
from ...model.result import History
from ...model.result import Solution
from ..newton.normal_newton import newton
from ..newton.settings import NewtonSettings
from .gradient_flow import flow
from .settings import FlowSettings

__all__ = ["flow_and_finish"]

HANDOVER = 1e-3  # error over the largest target at which Newton's method takes over; creases move by less than 2e-4 from there


def flow_and_finish(problem: CGCProblem, *, settings: Optional[FlowSettings] = None, callback: Callback = None) -> Solution:
    """Let the flow shape the creases, then take the regions between them to rounding by Newton's method.

    Without ``settings.finish`` this is the flow alone. With it, the flow hands over when
    the error is a thousandth of the target; if Newton's method does not arrive from
    there, the flow goes on to its own tolerance.
    """
    settings = settings or FlowSettings()
    if not settings.finish:
        return flow(problem, settings=settings, callback=callback)
    early = replace(settings, tolerance=max(settings.tolerance, HANDOVER) if settings.tolerance else 0.0)
    shaped = flow(problem, settings=early, callback=callback)
    if shaped.status not in ("converged", "step_limit", "stalled"):
        return shaped
    finished = _finish(problem, shaped, callback)
    if finished.status != "stalled" or shaped.status != "converged" or early.tolerance == settings.tolerance:
        return finished
    # The creases have waited already.
    left = replace(settings, steps=max(1, settings.steps - shaped.iterations), e=0)
    resumed = replace(problem.with_vertices(shaped.vertices), e=np.zeros(len(problem.vertices)))
    more = _joined(shaped, flow(resumed, settings=left, callback=_later(callback, shaped)))
    return _finish(problem, more, callback) if more.status == "converged" else more


def _finish(problem: CGCProblem, shaped: Solution, callback: Callback) -> Solution:
    """Return the finished solution, or the one given where Newton's method did not improve on it."""
    start = NewtonSettings(start="given")
    solution = newton(problem.with_vertices(shaped.vertices), settings=start, callback=_later(callback, shaped))
    joined = _joined(shaped, solution)
    if solution.status == "converged":
        steps = "step" if solution.iterations == 1 else "steps"
        message = f"converged after {shaped.iterations} steps of the flow and {solution.iterations} {steps} of Newton's method"
        return joined._replace(message=f"{message}: largest |K - K̄| {solution.max_error:.3g}")
    if solution.status == "cancelled":
        return joined
    return joined._replace(
        vertices=shaped.vertices,
        max_error=shaped.max_error,
        status="stalled" if shaped.status == "converged" else shaped.status,
        message=shaped.message,
    )


def _later(callback: Callback, before: Solution) -> Callback:
    """Return the callback with its steps and seconds counted on from a solution."""
    if callback is None:
        return None

    def told(state: Any) -> object:
        later = {"step": before.iterations, "steps": before.iterations, "seconds": before.seconds}
        return callback(state._replace(**{name: getattr(state, name) + more for name, more in later.items()}))

    return told


def _joined(first: Solution, second: Solution) -> Solution:
    """Return the second solution with the history of both."""
    histories = first.history, second.history
    columns = (np.concatenate([getattr(history, name) for history in histories]) for name in History._fields)
    return second._replace(
        iterations=first.iterations + second.iterations,
        seconds=first.seconds + second.seconds,
        history=History(*columns),
    )
