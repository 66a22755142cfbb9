"""The most that can be had of a goal that cannot be met."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import fields
from dataclasses import replace
from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...errors import ProblemError
from ...model.constraints import CROWN
from ...model.constraints import Constraint
from ...model.constraints import Height
from ...model.goals.binding import bind
from ...model.goals.inequalities import Above
from ...model.goals.inequalities import Below
from ...model.goals.inequalities import Bound
from ...model.goals.inequalities import Clearance
from ...model.goals.inequalities import NearPlane
from ...model.goals.names import goal_name
from ...model.goals.names import listed
from ...model.goals.wholes import Area
from ...model.goals.wholes import Length
from ...model.goals.wholes import Rise
from ...model.goals.wholes import Volume
from ...model.problem import CGCProblem
from ...model.result import Solution
from ...model.verdict import verdict

__all__ = ["Most", "has_number", "limit", "number_had", "number_of", "with_number"]

KINDS = (Height, Rise, Volume, Area, Length, Above, Below, Clearance, NearPlane)
HALVINGS = 6  # halvings of the interval between a feasible and an infeasible number; two digits
FAR = 8.0  # ratio of numbers of different magnitude; far too large numbers, in wrong units, come down in few solves

Solve = Callable[[CGCProblem, Optional[FloatArray]], Solution]  # from a shape (n, 3), if there is one


class Most(NamedTuple):
    """The most that can be had of a goal."""

    words: str
    solution: Optional[Solution] = None  # that meets the whole goal, if surfaces with less of it lead there


def limit(problem: CGCProblem, solution: Solution, solve: Solve) -> Optional[Most]:
    """Return how much of the first missed goal can be reached, or None if that is unknown.

    The surface without the goal is solved first; between what it has and what is asked for the most that can be met is
    looked for by halving, each from the surface before. Where the first surface is fair, so is the one with the most.

    Parameters
    ----------
    problem
        With its goals.
    solution
        That did not meet them.
    solve
        Solves a problem, from a shape (n, 3) if there is one, without coming back here.
    """
    missed = _missed(problem, solution)
    if missed is None:
        return None
    goal = problem.goals[missed]
    without = problem.with_goals(problem.goals[:missed] + problem.goals[missed + 1 :], add=False)
    free = found = solve(without, None)
    if free.status != "converged":
        return Most(f"the other goals cannot be met either, even without {goal_name(goal)}")
    had = number_had(problem, goal, free.vertices)
    others = [own for own in without.goals if has_number(own)]
    beside = f" with {listed([goal_name(own) for own in others])}" if others else _carrying(problem, goal, had)
    fair = _is_fair(problem, free)
    met, most = had, number_of(goal)
    for _ in range(HALVINGS):
        middle = _between(met, most)
        tried = list(problem.goals)
        tried[missed] = with_number(goal, middle)
        asked = problem.with_goals(tried, add=False)
        # What has no good start of its own is led up to.
        try:
            tries = (solve(asked, start) for start in (None, found.vertices))
            other = next((one for one in tries if one.status == "converged" and (not fair or _is_fair(problem, one))), None)
        except ProblemError:  # So little is no goal.
            break
        if other is not None:
            met, found = middle, other
        else:
            most = middle
    words = f"instead of {goal_name(goal)}, about {met:.4g} is possible{beside}"
    last = solve(problem, found.vertices)
    return Most(words, last if last.status == "converged" and _is_fair(problem, last) else None)


def _is_fair(problem: CGCProblem, solution: Solution) -> bool:
    """Return whether somebody would build a solution, whose K is that asked for or the one that was found."""
    posed = problem.with_vertices(solution.vertices)
    return verdict(solution.with_found(posed)).fair


def _carrying(problem: CGCProblem, goal: Constraint, had: float) -> str:
    """Return which K > 0 a surface of one K rises with as high as asked, from how high it is without the goal: h^2 goes with K."""
    targets = problem.targets[problem.asked]
    K = float(targets.min(initial=np.inf))
    if not isinstance(goal, Rise) or not 0.0 < K == float(targets.max(initial=0.0)) < np.inf or not had > 0.0 < goal.rise:
        return ""
    return (
        f" with K = {K:.4g}; without the goal the surface rises {had:.4g}, and K near {K * (goal.rise / had) ** 2:.2g} "
        f"rises {goal.rise:.4g}"
    )


def _between(met: float, most: float) -> float:
    """Return a number between one that is met and one that is not: what is far too much is brought down to its size first."""
    if abs(met) * FAR**2 < abs(most):
        return most / FAR
    return math.copysign(math.sqrt(met * most), most) if met * most > 0.0 and abs(most) > 2.0 * abs(met) else 0.5 * (met + most)


def _missed(problem: CGCProblem, solution: Solution) -> Optional[int]:
    """Return the place among the constraints of the goal with a number that is missed, or else of the first such goal."""
    able = [place for place, goal in enumerate(problem.goals) if has_number(goal)]
    for place in able:
        goal = problem.goals[place]
        had, wanted = number_had(problem, goal, solution.vertices), number_of(goal)
        short = wanted - had if not isinstance(goal, (Below, NearPlane)) else had - wanted
        if (short if isinstance(goal, Bound) else abs(short)) > 1e-6 * max(abs(wanted), abs(had)):
            return place
    return able[0] if able else None


def has_number(goal: Constraint) -> bool:
    """Return whether a goal asks for one number of the whole surface."""
    if isinstance(goal, Height):
        return goal.vertices == CROWN if isinstance(goal.vertices, str) else False
    return isinstance(goal, KINDS)


def number_of(goal: Constraint) -> float:
    """Return the number that a goal asks for."""
    return float(getattr(goal, _field(goal)))


def with_number(goal: Constraint, number: float) -> Constraint:
    """Return the same goal for another number."""
    changed: dict[str, Any] = {_field(goal): number}
    return replace(goal, **changed)


def _field(goal: Constraint) -> str:
    return next(field.name for field in fields(goal) if field.name in ("rise", "volume", "area", "length", "height", "distance"))


def number_had(problem: CGCProblem, goal: Constraint, vertices: FloatArray) -> float:
    """Return what a surface (n, 3) has of the number that a goal asks for."""
    goals = bind(problem.with_goals([goal], add=False))
    number = number_of(goal)
    if goals.equations:
        return goals.equations[0].value(vertices)
    slack = float(goals.sides[0].goal.slack(vertices[goals.sides[0].candidates(problem.vertices)])[0].min(initial=0.0))
    return number - slack if isinstance(goal, (Below, NearPlane)) else number + slack
