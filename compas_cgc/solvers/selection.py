"""Methods one after the other, until one arrives at a fair surface."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.space_form import EXACT
from ..errors import joined
from ..model.goals.wholes import Unknown
from ..model.measures import has_free_edges
from ..model.measures import is_held_all_round
from ..model.problem import CGCProblem
from ..model.recorder import Callback
from ..model.recorder import show_arrived
from ..model.result import Solution
from ..model.verdict import verdict
from .allowance import Allowance
from .choices import Choice
from .choices import choose
from .determined import determining
from .determined import held_to_goals
from .determined import missed_goal
from .determined import with_missed_added
from .drawn_side import hangs
from .drawn_side import is_drawn_below
from .evened import evened
from .half_sphere import with_half_a_sphere
from .larger_cap import with_larger_cap
from .method import Method
from .reasons import DRAWN_IN
from .reasons import contradiction
from .reasons import why_not_found
from .reasons import why_rough
from .registry import METHODS
from .registry import method_of
from .registry import settings_for
from .registry import settings_of
from .settings import Settings

__all__ = ["finished", "run_auto", "run_method"]

BELOW = "it goes to the side that it is drawn on, or a goal asks for, away from its normals, along which a flat drawing would go"
EVENED = "the surface is far from the drawing, whose triangles were laid out evenly over it"
CORRECTIONS = 8  # of goals; every one leaves about a tenth of what was missed
OVER = ("converged", "infeasible", "cancelled")  # statuses after which nothing else is tried


def run_method(
    method: Method,
    problem: CGCProblem,
    *,
    settings: Optional[Settings] = None,
    options: Mapping[str, Any] = MappingProxyType({}),
    callback: Callback = None,
) -> Solution:
    """Solve a problem by one method, see :class:`Method`, with some options other than the defaults where the settings leave them open."""
    return method.solve(problem, _own_settings(method, settings, options), callback)._replace(method=method.name)


def _own_settings(method: Method, settings: Optional[Settings], options: Mapping[str, Any]) -> Any:
    """Return the settings of a method, with some options other than the defaults where the settings leave them open."""
    own = settings_of(method, settings)
    given = settings.to_dict() if settings is not None and method_of(settings) == "auto" else {}
    options = {name: value for name, value in options.items() if given.get(name) in (None, "auto")}
    return replace(own, **options) if options else own


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
    held = any(is_held_all_round(problem, folded) for folded in (False, True))
    below = (held and is_drawn_below(problem)) or hangs(problem)
    for choice in choose(problem, settings):
        posed = problem
        if below and choice.method != "bending":
            posed, choice = problem.with_opposite_normals(), choice._replace(reason=f"{choice.reason}; {BELOW}")
        own = _Attempt(choice, settings, callback, allowed)
        solution = own.solved(posed, problem)
        judged = solution.verdict
        even = None if judged is None or judged.fair else evened(posed, solution.vertices)
        if even is not None:
            again = own.solved(posed.with_vertices(even), problem.with_vertices(even))
            if again.is_fair:
                solution, judged = again._replace(message=joined([again.message, EVENED])), again.verdict
        tried.append((solution, choice))
        if judged is not None:
            if judged.fair:
                return _told(with_larger_cap(problem, solution, callback) if held else solution, choice, tried)
            rough.append((judged.roughness, solution, choice))
        elif solution.status in OVER:
            break
        if allowed.spent or contradiction(problem):  # Nothing else arrives at what is not there.
            break
    last = tried[-1]
    # How much of a goal can be had says more than a rough surface with all of it.
    if rough and last[0].status != "infeasible":
        _, best, choice = min(rough, key=lambda one: one[0])
        reasons = partial(why_rough, problem)
    else:
        best, choice = last if last[0].status in OVER else min(tried, key=lambda pair: pair[0].max_error)
        reasons = partial(why_not_found, problem, best.status)
    with allowed.for_reasons().counted():
        why = reasons()
    best = best if why else with_half_a_sphere(problem, best)
    if best.method == "bending" and best.status != "cancelled" and has_free_edges(problem) and not contradiction(problem):
        why = joined([*filter(None, [why]), DRAWN_IN])
    return _told(best, choice, tried, why)


class _Attempt(NamedTuple):
    """A choice with what it is tried with."""

    choice: Choice
    settings: Optional[Settings]
    callback: Callback
    allowed: Allowance

    def solved(self, posed: CGCProblem, problem: CGCProblem) -> Solution:
        """Return the solution of a problem as it is posed to the method, which may be flipped, with a verdict where it has arrived."""
        method, options = METHODS[self.choice.method], self.choice.options
        run = partial(run_method, method, posed, settings=self.settings, options=options, callback=self.callback)
        solution = _judged(self.allowed.solved(run), problem, self.callback)
        return finished(solution, problem, self.choice, self.settings, self.callback)


def finished(
    solution: Solution, problem: CGCProblem, choice: Choice, settings: Optional[Settings] = None, callback: Callback = None
) -> Solution:
    """Return the surface that is found by the second method of a choice between the creases of a solution; the solution if it is not fair.

    Beside straight fixed edges, where one principal curvature is unbounded for K̄ > 0, mid-edge normals are less accurate than
    the smooth measure of Newton's method, which moves no creases. Goals that determine unknown K are asked for with what they
    miss on that surface added, until they are met there (deferred correction).
    """
    if choice.then is None:
        return solution
    first, numbers = solution, problem
    for _ in range(CORRECTIONS):
        if solution.status != "converged":
            return first
        between = _between_creases(solution, problem, choice.then, settings, callback)
        if between is None or missed_goal(problem, between) is None:
            return between or first
        corrected = with_missed_added(numbers, problem, between.vertices)
        if solution.targets is None or corrected is None:
            return first
        numbers = corrected
        solution = run_method(METHODS[choice.method], numbers, settings=settings, options=choice.options, callback=callback)
    return first


def _between_creases(
    solution: Solution, problem: CGCProblem, then: Choice, settings: Optional[Settings], callback: Callback
) -> Optional[Solution]:
    """Return the fair surface with the K and the creases of a solution, None where there is none."""
    posed = solution.with_found(problem).with_goals([], add=False)
    found = posed.with_vertices(solution.vertices)
    found = found.with_opposite_normals() if is_drawn_below(found) else found
    between = _judged(run_method(METHODS[then.method], found, settings=settings, options=then.options, callback=callback), posed, callback)
    if not between.is_fair:
        return None
    message = joined([between.message, "between the creases of a surface that bends and folds least"], " ")
    return between._replace(message=message, targets=solution.targets)


def _judged(solution: Solution, problem: CGCProblem, callback: Callback) -> Solution:
    """Return a solution of a problem with a verdict where it has arrived."""
    if solution.status != "converged":
        return solution._replace(verdict=None)
    asked = solution.with_found(problem)
    show_arrived(callback, solution.vertices)
    return solution._replace(verdict=solution.verdict or verdict(asked.with_vertices(solution.vertices), problem.vertices))


def _closed(problem: CGCProblem, found: Solution, settings: Settings, callback: Callback) -> Solution:
    """Return the nearest surface to one that was found whose triangles are congruent to those of its moulds."""
    if found.status != "converged":
        return found
    # The last step takes the K that was found as given.
    asked = found.with_found(problem).with_goals([goal for goal in problem.goals if not isinstance(goal, Unknown)], add=False)
    method, options = METHODS["projection"], {"keep": "shape"}
    own = run_method(method, asked.with_vertices(found.vertices), settings=settings, options=options, callback=callback)
    judged = verdict(asked.with_vertices(own.vertices), problem.vertices)
    moved = float(np.linalg.norm(own.vertices - found.vertices, axis=1).max())
    step = f"the last step to congruent triangles moved vertices by up to {moved:.3g}; before that: "
    message = joined([own.message, "; ", step, found.message], "")
    return own._replace(message=message, verdict=judged, targets=found.targets, laws=found.laws, branches=found.branches)


def _told(solution: Solution, choice: Choice, tried: list[tuple[Solution, Choice]], why: str = "") -> Solution:
    """Return the solution that was found, with why it is no better, by which method it was found, and what was tried before."""
    stopped = (f"{other.method} {said.status}" for said, other in tried if other is not choice and said.status != "converged")
    before = list(dict.fromkeys(stopped))
    if any(said.status == "converged" for said, other in tried if other is not choice):
        before.append("what was found first is rough")
    # What keeps a surface from being fair matters more than how well K is met on it.
    said = (why, solution.message) if solution.status == "converged" else (solution.message, why)
    method = f"by the method {choice.method}, as {choice.reason}" + (f" ({', '.join(before)})" if before else "")
    return solution._replace(message=joined([*filter(None, said), method]))
