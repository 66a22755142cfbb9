"""Newton's method on the curvature equations, from any start."""

from __future__ import annotations

import time
from typing import Callable
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...errors import ProblemError
from ...model.problem import CGCProblem
from ...model.problem import Frame
from ...model.result import History
from ...model.result import Solution
from ...model.result import SolveState
from ...model.result import stops
from .globalization import Outcome
from .globalization import steps_of
from .messages import message
from .polishing import model_errors
from .polishing import polished
from .settings import NewtonSettings
from .system import Step
from .system import System

__all__ = ["newton"]


def newton(
    problem: CGCProblem,
    settings: Optional[NewtonSettings] = None,
    callback: Optional[Callable[[SolveState], object]] = None,
) -> Solution:
    """Move the internal vertices along their normals until K is the target, to rounding.

    All other vertices stay where they are: fixed ones, dummies, creases, free edges. So
    it serves on its own where the boundaries of the regions are given, and as the finish
    after a method that shapes the creases. It needs K̄ >= 0, or a start near the target.

    A start that is not near is first made convex by :mod:`~compas_cgc.solvers.newton.elliptic`
    steps, whose number hardly depends on the size of the mesh.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets. Vertices on free edges must be carried by
        dummy faces.
    settings
        Parameters without units.
    callback
        Called with a :class:`SolveState` after every step. To cancel, return True or
        raise ``StopIteration``.

    Returns
    -------
    Solution
        With the last shape where it converged, was cancelled or ran out of steps; else
        with the best one. In the history the step length is the damping factor.

    Raises
    ------
    MeshError
        If K is asked for where no closed ring of faces measures it.
    ProblemError
        If K is asked for, but no target given.
    """
    started = time.perf_counter()
    settings = settings or NewtonSettings()
    without = np.flatnonzero(problem.asked & ~np.isfinite(problem.targets))
    if len(without):
        raise ProblemError([f"vertex {int(without[0])} is internal but has no target; give its region a K̄ or another role"])
    local, frame = problem.local()
    system = System(local, settings.backend)
    start = here = best = system.measure(local.vertices)
    rows: list[tuple] = []
    outcome: Optional[Outcome] = None
    run = steps_of(system, start, settings)
    while outcome is None:
        try:
            step = next(run)
        except StopIteration as end:
            outcome = end.value
            break
        here = step.shape
        best = here if system.errors(here)[0] < system.errors(best)[0] else best
        rows.append(_row(system, step, frame))
        if callback is not None:
            seconds = time.perf_counter() - started
            state = SolveState(len(rows), settings.steps, *rows[-1][:5], seconds, _to_model(problem, frame, here.vertices))
            if stops(callback, state):
                outcome = "cancelled", ""
        if outcome is None and len(rows) == settings.steps and here.largest > settings.tolerance:
            outcome = "step_limit", ""
    status, cause = outcome
    shape = best if status in ("stalled", "diverged", "infeasible") else here
    vertices = problem.vertices if shape is start else _to_model(problem, frame, shape.vertices)
    if status == "converged" and rows:
        vertices = polished(system, problem, frame, vertices)
    max_error = float(np.abs(model_errors(problem, vertices)[1]).max(initial=0.0))
    sentence = message(status, cause, len(rows), max_error, system, frame, system.dents(shape))
    return Solution(vertices, status, sentence, len(rows), time.perf_counter() - started, max_error, History.from_rows(rows))


def _row(system: System, step: Step, frame: Frame) -> tuple:
    error, norm = system.errors(step.shape)
    scale2 = frame.scale**2
    return step.shape.energy * frame.scale, norm / scale2, error / scale2, step.length, step.trials, True


def _to_model(problem: CGCProblem, frame: Frame, vertices: FloatArray) -> FloatArray:
    # What is held is handed back bit for bit, without the way through the frame.
    return np.where(problem.asked[:, None], frame.to_model(vertices), problem.vertices)
