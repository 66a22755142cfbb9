"""Newton's method on the curvature equations, along the normals, from any start."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace
from typing import Any
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.space_form import EXACT
from ...errors import ProblemError
from ...errors import Sentence
from ...errors import names_what_was_meant
from ...errors import use_method
from ...model.frame import Frame
from ...model.goals.binding import Equation
from ...model.goals.binding import bind
from ...model.goals.binding import held_by_newton
from ...model.goals.contradictions import refuse_impossible
from ...model.goals.guess import guessed
from ...model.measures import read_across
from ...model.problem import CGCProblem
from ...model.recorder import Callback
from ...model.recorder import Recorder
from ...model.result import Solution
from .globalization import Outcome
from .globalization import exact_steps
from .globalization import steps_of
from .goal_seeking import steps_to_goal
from .messages import message
from .polishing import model_errors
from .polishing import polished
from .settings import NewtonSettings
from .stages import Stages
from .system import Step
from .system import System

__all__ = ["newton"]


@names_what_was_meant()
def newton(problem: CGCProblem, *, settings: Optional[NewtonSettings] = None, callback: Callback = None) -> Solution:
    """Move the internal vertices along their normals until the error of K is at rounding level.

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

    Examples
    --------
    >>> import compas_cgc
    >>> plan = compas_cgc.read(compas_cgc.get("cushion.3dm")).to_problem()
    >>> newton(plan).status
    'converged'
    """
    settings = settings or NewtonSettings()
    posed, problem = problem, guessed(problem)
    without = np.flatnonzero(problem.asked & ~np.isfinite(problem.targets))
    if len(without):
        raise ProblemError([f"vertex {int(without[0])} is internal but has no target; give its region a K̄ or another role"])
    local, frame = problem.local()
    # Across the edge of a mesh that a dummy ring carries there is nothing to be read.
    smooth = settings.measure == "smooth" and local.real_faces.all()
    system = System(replace(local, faces=read_across(local)) if smooth else local, settings.backend)
    sought = _goal(local, posed, settings.measure)
    stages, met = Stages(system, settings.measure, settings.tolerance), None
    system = stages.beginning(system.measure(local.vertices))
    start = here = best = system.measure(local.vertices)
    outcome: Outcome

    def to_model(vertices: FloatArray) -> FloatArray:
        return _to_model(problem, frame, vertices)

    recorder = Recorder(settings.steps, callback, frame, to_model)
    run: Generator[Step, None, Any] = steps_of(system, start, settings)
    if sought is not None:
        run = steps_to_goal(system, start, sought, settings)
    while True:
        try:
            step = next(run)
        except StopIteration as end:
            outcome = end.value[:2]
            if sought is not None:
                system = end.value[2]
                here, best = system.measure(here.vertices), system.measure(best.vertices)
            if outcome[0] != "converged":
                if met is not None and settings.measure == "auto":
                    # The layout of the mesh could not be told from its wrinkles.
                    (system, here), outcome = met, ("converged", "")
                break
            met = system, here
            after = stages.following(system, here)
            if after is None:
                break
            system, here = after, after.measure(here.vertices)
            best = here
            run = exact_steps(after, here, settings) if sought is None else steps_to_goal(after, here, sought, settings)
            continue
        here = step.shape
        best = here if system.errors(here)[0] < system.errors(best)[0] else best
        error, norm = system.errors(here)
        recorder.record(here.energy, norm, error, step.length, step.trials)
        if recorder.cancelled(here.vertices):
            outcome = "cancelled", ""
            break
        if len(recorder) >= settings.steps and not system.meets(here, settings.tolerance):
            outcome = "step_limit", ""
            if met is not None and settings.measure == "auto":
                (system, here), outcome = met, ("converged", "")
            break
    status, cause = outcome
    shape = best if status in ("stalled", "diverged", "infeasible") else here
    vertices = problem.vertices if shape is start else to_model(shape.vertices)
    found = None if sought is None else system.problem.targets / frame.scale**2
    if found is not None:
        problem = replace(problem, targets=found)
    measure = stages.measure_of(system)
    if status == "converged" and measure == "defect" and not np.array_equal(system.problem.faces, local.faces):
        # The mesh is too coarse to estimate its layout error; K is then measured by angle defects, on the faces of the drawing.
        return newton(posed, settings=replace(settings, measure="defect"), callback=callback)
    if measure == "smooth":
        problem = replace(problem, faces=system.problem.faces, targets=system.equations.targets / frame.scale**2)
    if status == "converged" and len(recorder):
        vertices = polished(system, problem, frame, vertices, measure)
    max_error = float(np.abs(model_errors(problem, vertices, measure)[1]).max(initial=0.0))
    sentence = message(status, cause, len(recorder), max_error, system, frame, system.dents(shape), measure)
    if sought is not None and found is not None:
        sentence += f"; K = {found[problem.asked][0]:.6g} was found for {sought.name}"
    return Solution(
        vertices, status, sentence, len(recorder), recorder.seconds, max_error, recorder.history, measure=measure, targets=found
    )


def _goal(local: CGCProblem, posed: CGCProblem, measure: str) -> Optional[Equation]:
    """Return the goal that is the equation of the unknown K, None without any goals.

    Raises
    ------
    ProblemError
        If there is not one goal for one unknown K.
    """
    if not posed.goals:
        return None
    refuse_impossible(posed)
    if measure in EXACT:
        text = (
            f"the method newton finds an unknown K in the measures smooth and defect only; omit the measure {measure}, or "
            "use the method projection"
        )
        raise ProblemError([Sentence(text, [use_method("projection")])])
    goals = bind(local, posed.goals)
    if not held_by_newton(posed):
        text = "the method newton accepts only one goal of the whole surface, for one unknown K over fixed edges; use the method projection"
        raise ProblemError([Sentence(text, [use_method("projection")])])
    return goals.equations[0]


def _to_model(problem: CGCProblem, frame: Frame, vertices: FloatArray) -> FloatArray:
    # Vertices that are held keep their exact coordinates, without the rounding of the frame.
    return np.where(problem.asked[:, None], frame.to_model(vertices), problem.vertices)
