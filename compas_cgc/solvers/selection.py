"""Methods one after the other, until one arrives at a fair surface."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Any
from typing import Optional

from ..discrete.arrays import FloatArray
from ..errors import CGCError
from ..linalg.work import Work
from ..linalg.work import is_spent
from ..model.goals.binding import unknown_regions
from ..model.problem import CGCProblem
from ..model.recorder import Callback
from ..model.recorder import show_arrived
from ..model.result import Solution
from ..model.verdict import verdict
from .allowance import AS_MEANT
from .allowance import DRAWN
from .allowance import PLANNED
from .allowance import Allowance
from .anew import MANY
from .anew import solved_anew
from .choices import ANEW
from .choices import FLOW
from .choices import FLOW_STEPS
from .choices import FREED
from .choices import LOST
from .choices import Choice
from .choices import choose
from .choices import is_due
from .choices import is_last_resort
from .columns import Attempt
from .columns import column_advice
from .domed import solved_from_dome
from .drawn_side import is_drawn_below
from .half_sphere import with_half_a_sphere
from .method import Method
from .projection import ProjectionSettings
from .reasons import contradiction
from .reasons import why_not_found
from .reasons import why_rough
from .registry import METHODS
from .registry import method_of
from .registry import settings_of
from .rising import is_held_all_round
from .settings import Settings
from .smoothed import solved_as_drawn
from .smoothed import solved_smoothed
from .smoothed import solved_turned
from .supported import solved_from_supports
from .turned_edges import on_turned_edges

__all__ = ["run_auto", "run_method"]

LARGE, SEARCH = 2000, 2e7  # vertices, and right sides times unknowns, of a search for heights of columns: some three seconds at most
BELOW = "it goes to the side that it is drawn on, away from its normals, along which a flat drawing would go"
RISEN = "step by step from smaller targets it is fair"
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
    options = {name: value for name, value in options.items() if given.get(name) is None}
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
    tried: list[tuple[Solution, Choice]] = []
    rough: list[tuple[float, Solution, Choice]] = []  # that arrived
    allowed = Allowance(problem, settings)
    general = settings is None or method_of(settings) == "auto"
    below = general and any(is_held_all_round(problem, folded) for folded in (False, True)) and is_drawn_below(problem)
    choices = choose(problem, settings)
    for choice in choices:
        if allowed.spent and tried:
            break
        if not is_due(choice, bool(rough)) or (choice.start == "meant" and any(other is LOST for _, other in tried)):
            continue
        if tried and is_last_resort(choice) and contradiction(problem):  # Nothing else arrives at what is not there.
            break
        if choice.start == "anew" and rough and not allowed.as_much_again:  # The others go on from what there is.
            continue
        options = {**choice.options, "steps": allowed.flow_steps(FLOW_STEPS)} if choice.options is FLOW.options else choice.options
        run = partial(run_method, METHODS[choice.method], settings=settings, options=options, callback=callback)
        posed = problem
        if below and (choice.method == "newton" or choice.start == "domed"):
            posed, choice = problem.flipped(), choice._replace(reason=f"{choice.reason}; {BELOW}")
        if choice.start == "domed":
            own = _own_settings(METHODS[choice.method], settings, options)
            found = allowed.solved(partial(solved_from_dome, posed, own, callback))
        elif choice.start == "anew":
            freed = partial(run_method, METHODS[choice.method], settings=settings, options=FREED, callback=callback)
            found = allowed.solved(partial(solved_anew, problem, run, freed, callback))
        elif choice.start == "supports":
            found = allowed.solved(partial(solved_from_supports, problem, run))
        elif choice.start == "edges":
            found = allowed.solved(partial(on_turned_edges, problem, run, solved_smoothed))
        elif choice.start == "meant":
            found = allowed.solved(partial(solved_as_drawn, problem, run), *([AS_MEANT] if choice is LOST else []))
        elif choice.start == "smoothed":
            found = allowed.solved(partial(solved_smoothed, problem, _nearest(rough, tried), run))
        elif choice.start == "turned":
            found = allowed.solved(partial(solved_turned, problem, _nearest(rough, tried), run))
        else:
            found = allowed.solved(partial(run, posed), math.inf if tried else _for_the_first(problem, choices))
        if found is None:
            continue
        solution = found
        tried.append((solution, choice))
        if solution.status == "converged":
            asked = problem if solution.targets is None else problem.with_targets(solution.targets)
            asked = asked if solution.faces is None else replace(asked, faces=solution.faces)
            if solution.faces is None:
                show_arrived(callback, solution.vertices)
            judged = verdict(asked.with_vertices(solution.vertices), problem.vertices)
            solution = solution._replace(verdict=judged)
            if judged.fair:
                return _told(solution, choice, tried)
            # Turned it is not what the normals say, or has not the faces of the drawing: worth it for a fair one alone.
            if choice.start not in ("turned", "edges"):
                rough.append((judged.roughness, solution, choice))
        elif solution.status in OVER:
            if not rough:
                with allowed.for_reasons().counted():
                    why = why_not_found(problem, solution.status, cold=_attempt)
                return _told(solution, choice, tried, why.text)
            break
    if rough:
        _, best, choice = min(rough, key=lambda one: one[0])
        reasons = partial(why_rough, problem)
    else:
        best, choice = min(tried, key=lambda pair: pair[0].max_error)
        reasons = partial(why_not_found, problem, best.status)
    with allowed.for_reasons().counted():
        why = reasons(partial(_columns, problem, best), _attempt)
    risen = _as_set(problem, why.surface, settings, callback) if why.surface is not None else None
    if risen is not None:
        return _told(risen, Choice(risen.method, RISEN, True), tried)
    return _told(best if why.text else with_half_a_sphere(problem, best), choice, tried, why.text)


def _for_the_first(problem: CGCProblem, choices: list[Choice]) -> float:
    """Return the right sides that the first search may take, where another start leads there sooner than it would."""
    if LOST in choices:
        return DRAWN
    return PLANNED if ANEW in choices and len(problem.vertices) >= MANY else math.inf


def _as_set(problem: CGCProblem, surface: Solution, settings: Optional[Settings], callback: Callback) -> Optional[Solution]:
    """Return a fair surface as the settings ask for it, found on from it; None where it is not fair by them."""
    if settings is None:
        return surface
    if method_of(settings) not in ("auto", surface.method):
        return None
    options = LOST.options if surface.method == LOST.method else {}
    own = run_method(
        METHODS[surface.method], problem.with_vertices(surface.vertices), settings=settings, options=options, callback=callback
    )
    if own.status != "converged":
        return None
    judged = verdict(problem.with_vertices(own.vertices), problem.vertices)
    return own._replace(verdict=judged) if judged.fair else None


def _nearest(rough: list[tuple[float, Solution, Choice]], tried: list[tuple[Solution, Choice]]) -> FloatArray:
    """Return the surface (n, 3) that came nearest to a fair one."""
    if rough:
        return min(rough, key=lambda one: one[0])[1].vertices
    return min(tried, key=lambda pair: pair[0].max_error)[0].vertices


def _columns(problem: CGCProblem, rough: Solution) -> str:
    """Return which columns are in the way of a surface of K > 0, and what heights they may have, where that is found soon."""
    if len(problem.vertices) > LARGE or not problem.real_faces.all() or unknown_regions(problem):
        return ""
    judged = rough.verdict or verdict(problem.with_vertices(rough.vertices), problem.vertices)
    with Work(SEARCH).counted():
        return column_advice(problem, Attempt(rough.vertices, judged), _attempt)


def _attempt(problem: CGCProblem) -> Optional[Attempt]:
    """Return the first fair surface that the methods arrive at, else the last that they do."""
    found: Optional[Attempt] = None
    for choice in choose(problem):
        if is_spent():
            break
        if (
            choice.options is FLOW.options
            or choice is LOST
            or choice.start not in ("domed", "drawn", "meant")
            or (choice.second and found is None)
        ):
            continue
        try:
            if choice.start == "domed":
                solution = solved_from_dome(problem.flipped() if is_drawn_below(problem) else problem, ProjectionSettings())
            else:
                solution = run_method(METHODS[choice.method], problem, options=choice.options)
        except CGCError:  # Goals that name what is there no more.
            return None
        if solution is not None and solution.status == "converged":
            found = Attempt(solution.vertices, verdict(problem.with_vertices(solution.vertices), problem.vertices))
            if found.judged.fair:
                break
    return found


def _told(solution: Solution, choice: Choice, tried: list[tuple[Solution, Choice]], why: str = "") -> Solution:
    """Return the solution that was found, with why it is no better, by which method it was found, and what was tried before."""
    stopped = (f"{other.method} {said.status}" for said, other in tried if other is not choice and said.status != "converged")
    before = list(dict.fromkeys(stopped))
    if choice.second and any(said.status == "converged" for said, other in tried if other is not choice):
        before.append("what was found first is rough")
    why = why.lstrip("; ")
    # What keeps a surface from being fair matters more than how well K is met on it.
    said = (why, solution.message) if solution.status == "converged" else (solution.message, why)
    text = "; ".join([*filter(None, said), f"by the method {choice.method}, as {choice.reason}"])
    if before:
        text += f" ({', '.join(before)})"
    return solution._replace(message=text)
