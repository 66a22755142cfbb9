"""The methods on arrays, each by its name, behind one call."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Callable
from typing import Optional
from typing import Union

import numpy as np

from ..model.constraints import Constraint
from ..model.problem import CGCProblem
from ..model.result import History
from ..model.result import Solution
from ..model.result import SolveState
from .flow import FlowSettings
from .flow import flow
from .newton import NewtonSettings
from .newton import newton
from .projection import ProjectionSettings
from .projection import project

__all__ = ["METHODS", "SETTINGS", "Settings", "flow_and_finish", "run"]

Settings = Union[FlowSettings, NewtonSettings, ProjectionSettings]
Callback = Optional[Callable[[SolveState], object]]

SETTINGS = {"flow": FlowSettings, "newton": NewtonSettings, "projection": ProjectionSettings}
METHODS = tuple(SETTINGS)

HANDOVER = 1e-3  # error, against the largest target, at which the creases hardly move any more


def run(
    method: str,
    problem: CGCProblem,
    settings: Optional[Settings] = None,
    constraints: Sequence[Constraint] = (),
    callback: Callback = None,
) -> Solution:
    """Solve a problem by one method.

    Flow and Newton's method ask for K on free edges too, carried by a dummy ring for
    the time of the solve; projection leaves K open there.

    Parameters
    ----------
    method
        ``"flow"``, ``"newton"`` or ``"projection"``.
    problem
        Vertices, faces, roles and targets.
    settings
        Of this method. Default: its own.
    constraints
        For projection.
    callback
        Called after every step.

    Returns
    -------
    Solution
        With the vertices of the problem, in its order.
    """
    if method == "projection":
        return project(problem, settings, constraints, callback)._replace(method=method)
    carried = problem.with_dummy_ring()
    own = len(problem.vertices)
    seen = callback if callback is None else lambda state: callback(state._replace(vertices=state.vertices[:own]))
    if method == "newton":
        solution = newton(carried, settings, seen)
    else:
        solution = flow_and_finish(carried, settings or FlowSettings(), seen)
    return solution._replace(vertices=solution.vertices[:own], method=method)


def flow_and_finish(problem: CGCProblem, settings: FlowSettings, callback: Callback = None) -> Solution:
    """Let the flow shape the creases, then take the regions between them to rounding by Newton's method.

    Without ``settings.finish`` this is the flow alone. With it, the flow hands over when
    the error is a thousandth of the target; if Newton's method does not arrive from
    there, the flow goes on to its own tolerance.
    """
    if not settings.finish:
        return flow(problem, settings, callback)
    early = replace(settings, tolerance=max(settings.tolerance, HANDOVER) if settings.tolerance else 0.0)
    shaped = flow(problem, early, callback)
    if shaped.status not in ("converged", "step_limit", "stalled"):
        return shaped
    finished = _finish(problem, shaped, callback)
    if finished.status != "stalled" or shaped.status != "converged" or early.tolerance == settings.tolerance:
        return finished
    left = replace(settings, steps=max(1, settings.steps - shaped.iterations))
    # The creases have waited already, whoever told them to.
    rest = replace(_at(problem, shaped), e=np.zeros(len(problem.vertices)))
    more = _joined(shaped, flow(rest, left, _later(callback, shaped)))
    return _finish(problem, more, callback) if more.status == "converged" else more


def _finish(problem: CGCProblem, shaped: Solution, callback: Callback) -> Solution:
    """Return the finished solution, or the one given where Newton's method did not improve on it."""
    solution = newton(_at(problem, shaped), NewtonSettings(start="given"), _later(callback, shaped))
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


def _at(problem: CGCProblem, solution: Solution) -> CGCProblem:
    return replace(problem, vertices=solution.vertices)


def _later(callback: Callback, before: Solution) -> Callback:
    """Return the callback with its steps and seconds counted on from a solution."""
    if callback is None:
        return None
    return lambda state: callback(
        state._replace(step=state.step + before.iterations, steps=state.steps + before.iterations, seconds=state.seconds + before.seconds)
    )


def _joined(first: Solution, second: Solution) -> Solution:
    """Return the second solution with the history of both."""
    return second._replace(
        iterations=first.iterations + second.iterations,
        seconds=first.seconds + second.seconds,
        history=History(*(np.concatenate(pair) for pair in zip(first.history, second.history))),
    )
