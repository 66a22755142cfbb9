"""On from a result: the surface that was found leads to that of other targets, over the same drawing."""

from __future__ import annotations

from collections.abc import Callable
from typing import Optional

import numpy as np

from ..errors import joined
from ..model.goals.binding import unknown_constants
from ..model.problem import CGCProblem
from ..model.recorder import Callback
from ..model.recorder import show_arrived
from ..model.result import Solution
from ..model.result import SolveState
from ..model.verdict import verdict
from .between_lines import between_lines
from .choices import Choice
from .choices import choose
from .polish.polisher import polish
from .projection.projector import Projector
from .projection.projector import ready
from .projection.symmetry import tears_faces
from .registry import METHODS
from .registry import settings_of
from .settings import Settings

__all__ = ["solved_on", "steps_towards"]


def solved_on(
    problem: CGCProblem, drawn: CGCProblem, method: str = "auto", settings: Optional[Settings] = None, callback: Callback = None
) -> Optional[Solution]:
    """Return the fair surface that one found before leads on to.

    Distances are still measured from the drawing: so the surface does not depend on the way of the targets.

    Parameters
    ----------
    problem
        With its vertices on a surface that was found for other targets.
    drawn
        The same problem over the drawing that was found for.
    method, settings
        As for :func:`compas_cgc.solve`.
    callback
        Called after every step.

    Returns
    -------
    Solution or None
        None where it leads to no fair one, nothing changes, K changes its sign or a law its type, or neither bending nor the projection is
        chosen.
    """
    before = problem if problem.origin is None else problem.origin.drawn
    if np.array_equal(before.targets, problem.targets, equal_nan=True) and before.laws == problem.laws:
        # The same problem has the same surface, to the last digit.
        return None
    first = choose(drawn, settings)[0] if method == "auto" else Choice(method, "it was given")
    own = settings_of(METHODS[first.method], settings)
    if first.then:
        # These do not depend on a start.
        between = between_lines(drawn, first, settings, callback)
        if between is not None:
            return between
    if first.method == "bending":
        if unknown_constants(drawn) or not _of_same_types(problem, before):
            # From a dome no way leads to a saddle.
            return None
        if problem.origin is not None and problem.origin.evenness:
            # From a surface of even curvature a way leads to others of least bending than from the drawing.
            return None
        solution = polish(drawn, settings=own, start=problem.vertices, callback=callback)  # type: ignore[arg-type]
    elif first.method == "projection" and not first.options and not tears_faces(drawn):
        if (problem.types < 0).any() or (before.types < 0).any():
            # From one saddle to the next a way leads to others than from the drawing, as there are many of nearly the same energy.
            return None
        projector = Projector(drawn, settings=own) if drawn.goals else ready(drawn, own)  # type: ignore[arg-type]
        solution = projector.solve(problem.targets, problem.vertices, callback=callback)
    else:
        return None
    if solution.status == "cancelled":
        return solution._replace(method=first.method)
    if solution.status != "converged":
        return None
    if solution.faces is None:
        show_arrived(callback, solution.vertices)
    judged = solution.verdict or verdict(solution.with_found(drawn).with_vertices(solution.vertices), drawn.vertices)
    message = joined([solution.message, f"by the method {first.method}, starting from the previous surface"])
    return solution._replace(method=first.method, verdict=judged, message=message) if judged.fair else None


def _of_same_types(problem: CGCProblem, before: CGCProblem) -> bool:
    """Return whether all targets have the same signs, and all laws the same types."""
    types = [{region: law.type for region, law in own.laws.items()} for own in (problem, before)]
    return np.array_equal(problem.types, before.types, equal_nan=True) and types[0] == types[1]


def steps_towards(problem: CGCProblem, surface: CGCProblem, steps: int, callback: Callable[[SolveState], object]) -> None:
    """Show the first steps of the projection from a surface towards the one of other targets over the same drawing.

    Parameters
    ----------
    problem
        The problem as drawn, with the new targets.
    surface
        A result's problem. Without the same drawing, supports, creases and signs of K, nothing is shown.
    steps
        Number of steps.
    callback
        Called after every step; return True to stop.
    """
    origin, start = surface.origin, surface.vertices
    if (
        origin is None
        or problem.goals
        or problem.laws
        or not all(
            np.array_equal(getattr(problem, name), getattr(origin.drawn, name)) for name in ("vertices", "faces", "roles", "creases")
        )
    ):
        return
    if (problem.types != origin.drawn.types)[problem.asked].any() or np.isnan(problem.targets[problem.asked]).any():
        return
    ready(problem).solve(problem.targets, start, callback=lambda state: bool(callback(state)) or state.step >= steps)
