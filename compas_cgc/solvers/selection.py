"""Methods one after the other, until one arrives at a fair surface."""

from __future__ import annotations

from functools import partial
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.space_form import EXACT
from ..errors import joined
from ..errors import without_more_steps
from ..model.goals.wholes import Unknown
from ..model.measures import has_free_edges
from ..model.measures import is_held_all_round
from ..model.measures import is_held_along_edges
from ..model.problem import CGCProblem
from ..model.recorder import Callback
from ..model.result import Solution
from ..model.verdict import verdict
from .allowance import Allowance
from .between_lines import between_lines
from .choices import Choice
from .choices import choose
from .determined import determining
from .determined import held_to_goals
from .drawn_side import hangs
from .drawn_side import is_drawn_below
from .evened import evened
from .evened import pulled_taut
from .half_sphere import with_half_a_sphere
from .larger_cap import with_larger_cap
from .reasons import DRAWN_IN
from .reasons import contradiction
from .reasons import why_not_found
from .reasons import why_rough
from .registry import METHODS
from .registry import method_of
from .registry import settings_for
from .running import judged
from .running import run_method
from .settings import Settings

__all__ = ["run_auto"]

BELOW = "the surface rises against the normals, because the drawing or a goal lies on that side"
EVENED = "the surface is far from the drawing; the triangles of the drawing were distributed evenly over the surface"
OVER = ("converged", "infeasible", "cancelled")  # statuses after which nothing else is tried


def run_auto(problem: CGCProblem, *, settings: Optional[Settings] = None, callback: Callback = None) -> Solution:
    """Solve by the first method that arrives at a fair surface; else return the first that arrived, or came nearest.

    Parameters
    ----------
    problem
        Vertices, faces, roles, targets and constraints.
    settings
        Of one of the methods, which is then the one to use, or those that all have.
    callback
        Called after every step of every method that is tried.
    """
    measure = "auto" if settings is None else settings.to_dict().get("measure", "auto")
    free = settings is None or method_of(settings) == "auto"
    alone = determining(problem) if free else None
    if alone is not None:
        return held_to_goals(problem, alone, partial(run_auto, settings=settings, callback=callback))
    if settings is not None and free and measure in EXACT:
        general = settings_for("auto", {**settings.to_dict(), "measure": "auto"})
        return _closed(problem, run_auto(problem, settings=general, callback=callback), settings, callback)
    tried: list[tuple[Solution, Choice]] = []
    rough: list[tuple[float, Solution, Choice]] = []  # that arrived
    allowed = Allowance(problem, settings)
    held = is_held_all_round(problem) or (is_held_along_edges(problem) and not has_free_edges(problem))
    below = (held and is_drawn_below(problem)) or hangs(problem)
    for choice in choose(problem, settings):
        posed = problem
        if below:
            # Bending finds the side of a drawing itself.
            posed = problem if choice.method == "bending" else problem.with_opposite_normals()
            choice = choice._replace(reason=f"{choice.reason}; {BELOW}")
        own = _Attempt(choice, settings, callback, allowed)
        solution = own.solved(posed, problem)
        if solution is None:
            continue
        even = _evened(posed, solution)
        if even is not None:
            again = own.solved(posed.with_vertices(even), problem.with_vertices(even))
            if again is not None and again.is_fair:
                solution = again._replace(message=joined([again.message, EVENED]))
        tried.append((solution, choice))
        if solution.is_fair:
            return _told(with_larger_cap(problem, solution, callback) if held else solution, choice, tried)
        if solution.verdict is not None:
            rough.append((solution.verdict.roughness, solution, choice))
        elif solution.status in OVER:
            break
        if allowed.spent or contradiction(problem):  # Nothing else arrives at what is not there.
            break
    last = tried[-1]
    # How much of a goal can be had says more than a rough surface with all of it.
    if rough and last[0].status != "infeasible":
        _, best, choice = min(rough, key=lambda one: one[0])
        reasons = partial(why_rough, problem, best.method == "bending")
    else:
        best, choice = last if last[0].status in OVER else min(tried, key=lambda pair: pair[0].max_error)
        reasons = partial(why_not_found, problem, best.status, settings is not None and settings.to_dict().get("steps") is not None)
    with allowed.for_reasons().counted():
        why = reasons()
    best = best if why else with_half_a_sphere(problem, best)
    loose = best.method == "bending" and best.status != "cancelled" and has_free_edges(problem) and not contradiction(problem)
    return _told(best, choice, tried, why, DRAWN_IN if loose else "")


def _evened(problem: CGCProblem, solution: Solution) -> Optional[FloatArray]:
    """Return the drawing (n, 3) with even triangles over a rough surface, or pulled taut over its boundary; None where neither gains."""
    if solution.is_fair or solution.status in ("cancelled", "infeasible"):
        return None
    even = None if solution.verdict is None else evened(problem, solution.vertices)
    return pulled_taut(problem) if even is None else even


class _Attempt(NamedTuple):
    """A choice with what it is tried with."""

    choice: Choice
    settings: Optional[Settings]
    callback: Callback
    allowed: Allowance

    def solved(self, posed: CGCProblem, problem: CGCProblem) -> Optional[Solution]:
        """Return the solution of a problem as it is posed to the method, which may be flipped, with a verdict where it has arrived.

        None where no fair surface lies between the lines that were found.
        """
        if self.choice.then:
            return self.allowed.solved(partial(between_lines, problem, self.choice, self.settings, self.callback))
        method, options = METHODS[self.choice.method], self.choice.options
        run = partial(run_method, method, posed, settings=self.settings, options=options, callback=self.callback)
        return judged(self.allowed.solved(run), problem, self.callback)


def _closed(problem: CGCProblem, found: Solution, settings: Settings, callback: Callback) -> Solution:
    """Return the nearest surface to one that was found whose triangles are congruent to those of its moulds."""
    if found.status != "converged":
        return found
    # The last step takes the K that was found as given.
    asked = found.with_found(problem).with_goals([goal for goal in problem.goals if not isinstance(goal, Unknown)], add=False)
    method, options = METHODS["projection"], {"keep": "shape"}
    own = run_method(method, asked.with_vertices(found.vertices), settings=settings, options=options, callback=callback)
    again = verdict(asked.with_vertices(own.vertices), problem.vertices)
    moved = float(np.linalg.norm(own.vertices - found.vertices, axis=1).max())
    step = f"the last step to congruent triangles moved vertices by up to {moved:.3g}; before that: "
    message = joined([own.message, "; ", step, found.message], "")
    return own._replace(message=message, verdict=again, targets=found.targets, laws=found.laws, branches=found.branches)


def _told(solution: Solution, choice: Choice, tried: list[tuple[Solution, Choice]], why: str = "", hint: str = "") -> Solution:
    """Return the solution that was found, with why it is no better, what may help, by which method it was found, and what was tried."""
    stopped = (f"{other.method} {said.status}" for said, other in tried if other is not choice and said.status != "converged")
    before = list(dict.fromkeys(stopped))
    if any(said.status == "converged" for said, other in tried if other is not choice):
        before.append("an earlier result was rough")
    if why and solution.status == "step_limit":
        solution = solution._replace(message=without_more_steps(solution.message))
    # What keeps a surface from being fair matters more than how well K is met on it, or how many steps were taken.
    said = (why, solution.message) if solution.status in ("converged", "step_limit") else (solution.message, why)
    method = f"by the method {choice.method}, as {choice.reason}" + (f" ({', '.join(before)})" if before else "")
    return solution._replace(message=joined([*filter(None, (*said, hint)), method]))
