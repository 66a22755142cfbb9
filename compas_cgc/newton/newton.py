"""Newton's method on the curvature equations, from any start."""

from __future__ import annotations

import time
from collections.abc import Generator
from collections.abc import Iterator
from typing import Callable
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..errors import ProblemError
from ..linalg import SingularMatrixError
from ..problem import CGCProblem
from ..problem import Frame
from ..result import History
from ..result import Solution
from ..result import SolveState
from .damped import at_rounding
from .damped import damped_newton
from .elliptic import elliptic_steps
from .feasible import overload
from .membrane import membrane
from .messages import message
from .settings import NewtonSettings
from .system import Shape
from .system import Step
from .system import System

__all__ = ["newton"]

NEAR = 0.5  # error of K, against its target, from which Newton's method needs no other start
BOUNDS = (1.0, 10.0, 100.0)  # factors on Λ of one elliptic start after the other
SAME = 1e-3  # distance, against the diagonal, of a start that is no other start
RUNAWAY = 2.0  # a vertex that moved this many diagonals of the model will not come back


def newton(
    problem: CGCProblem,
    settings: Optional[NewtonSettings] = None,
    callback: Optional[Callable[[SolveState], object]] = None,
) -> Solution:
    """Move the internal vertices along their normals until K is the target, to rounding.

    All other vertices stay where they are: fixed ones, dummies, creases, free edges. So
    it serves on its own where the boundaries of the regions are given, and as the finish
    after a method that shapes the creases. It needs K̄ > 0, or a start near the target.

    A start that is not near is first made convex by :mod:`~compas_cgc.newton.elliptic`
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
    local, frame = problem.local()
    without = np.flatnonzero(local.asked & ~np.isfinite(local.targets))
    if len(without):
        raise ProblemError([f"vertex {int(without[0])} is internal but has no target; give its region a K̄ or another role"])
    system = System(local, settings.backend)
    here = best = system.measure(local.vertices)
    rows: list[tuple] = []
    run = _run(system, here, settings)
    while True:
        try:
            step = next(run)
        except StopIteration as end:
            status, cause = end.value
            break
        here = step.shape
        if not system.errors(here)[0] >= system.errors(best)[0]:
            best = here
        rows.append(_row(system, step, frame))
        seconds = time.perf_counter() - started
        if callback is not None:
            state = SolveState(len(rows), settings.steps, *rows[-1][:5], seconds, _to_model(problem, frame, here.vertices))
            if _stops(callback, state):
                status, cause = "cancelled", ""
                break
        if len(rows) == settings.steps and here.largest > settings.tolerance:
            status, cause = "step_limit", ""
            break
    shape = best if status in ("stalled", "diverged") else here
    max_error = system.errors(shape)[0] / frame.scale**2
    return Solution(
        _to_model(problem, frame, shape.vertices) if shape.vertices is not local.vertices else problem.vertices,
        status,
        message(status, cause, len(rows), max_error, system, frame),
        len(rows),
        time.perf_counter() - started,
        max_error,
        History.from_rows(rows),
    )


class _RanAway(Exception):
    pass


def _run(system: System, start: Shape, settings: NewtonSettings) -> Generator[Step, None, tuple[str, str]]:
    """Yield the steps of a solve; return its status and a cause where it did not converge."""
    if start.largest <= settings.tolerance:
        return "converged", ""
    only_given = settings.start == "given" or bool((system.targets < 0).any())
    near = settings.start == "auto" and _is_near(system, start)
    try:
        if only_given or near:
            end = yield from _finished(system, start, settings)
            if _is_solved(system, end, settings):
                return "converged", ""
            if only_given:
                return "stalled", "start"
        too_much = overload(system)
        if too_much is not None:
            return "infeasible", too_much
        outcome = yield from _from_elliptic(system, start, settings)
        if outcome != "converged":
            taut = membrane(system)
            if float(np.abs(taut - start.vertices).max()) > SAME * _size(system):
                outcome = yield from _from_elliptic(system, system.measure(taut), settings)
    except SingularMatrixError:
        return "stalled", "singular"
    return outcome, "target"


def _from_elliptic(system: System, shape: Shape, settings: NewtonSettings) -> Generator[Step, None, str]:
    """Yield elliptic steps, then Newton's, and return how they ended.

    Where Newton's method stalls, the elliptic steps go on nearer to its equations.
    """
    try:
        for factor in BOUNDS:
            shape = yield from _followed(system, shape, elliptic_steps(system, shape, factor * settings.anisotropy))
            end = yield from _finished(system, shape, settings)
            if _is_solved(system, end, settings):
                return "converged"
    except _RanAway:
        return "diverged"
    return "stalled"


def _finished(system: System, shape: Shape, settings: NewtonSettings) -> Generator[Step, None, Shape]:
    """Yield Newton's steps and return the last shape."""
    return _followed(system, shape, damped_newton(system, shape, settings.tolerance, settings.shortest))


def _followed(system: System, shape: Shape, steps: Iterator[Step]) -> Generator[Step, None, Shape]:
    """Yield the steps and return the last shape."""
    for step in steps:
        shape = step.shape
        far = float(np.abs(shape.vertices - system.problem.vertices).max())
        if not (np.isfinite(shape.largest) and far < RUNAWAY * _size(system)):
            raise _RanAway
        yield step
    return shape


def _size(system: System) -> float:
    return float(np.linalg.norm(np.ptp(system.problem.vertices, axis=0)))


def _is_near(system: System, shape: Shape) -> bool:
    scale = np.where(system.targets > 0, system.targets, system.scale)
    return bool((np.abs(shape.curvature - system.targets) <= NEAR * scale).all())


def _is_solved(system: System, shape: Shape, settings: NewtonSettings) -> bool:
    return shape.largest <= settings.tolerance or at_rounding(system, shape)


def _row(system: System, step: Step, frame: Frame) -> tuple:
    error, norm = system.errors(step.shape)
    scale2 = frame.scale**2
    return step.shape.energy * frame.scale, norm / scale2, error / scale2, step.length, step.trials, True


def _to_model(problem: CGCProblem, frame: Frame, vertices: FloatArray) -> FloatArray:
    # What is held is handed back bit for bit, without the way through the frame.
    return np.where(problem.asked[:, None], frame.to_model(vertices), problem.vertices)


def _stops(callback: Callable[[SolveState], object], state: SolveState) -> bool:
    try:
        return callback(state) is True
    except StopIteration:
        return True
