"""Goals over a rim that is held all round with K > 0 given: they hold of the one surface there is, or they cannot be met."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..errors import FOUND
from ..errors import Remedy
from ..errors import Sentence
from ..errors import joined
from ..model.constraints import Constraint
from ..model.constraints import Height
from ..model.goals.binding import bind
from ..model.goals.binding import held_by_newton
from ..model.goals.binding import unknown_constants
from ..model.goals.inequalities import Bound
from ..model.goals.names import goal_name
from ..model.goals.wholes import Unknown
from ..model.goals.wholes import Whole
from ..model.measures import is_held_all_round
from ..model.problem import CGCProblem
from ..model.result import Solution
from ..model.tolerances import DRAWING_ACCURACY
from .projection.limits import has_number
from .projection.limits import number_had

__all__ = ["determining", "held_to_goals", "missed_goal"]

MEND = "choose another K, or free a part of the rim"
FIND = Sentence("let the solve determine K (unknown), ", [FOUND])
HELD = "the surface that the rim and K determine meets the goals"
DETERMINED = "the rim and K = {:.4g} determine the surface"


def determining(problem: CGCProblem) -> Optional[CGCProblem]:
    """Return a problem with those goals alone that determine its surface together with the rim and K > 0; None where they do not.

    Among the graphs over a plan it is unique on either side (comparison principle of the Monge-Ampère equation). One unknown K needs one
    goal; all others can only be held against the surface. Places of vertices are no such goals: they pull at the surface as masts do.
    """
    if not all(has_number(goal) or isinstance(goal, (Bound, Unknown)) for goal in problem.goals):
        return None
    needed = [goal for goal in problem.goals if not isinstance(goal, Bound)] if unknown_constants(problem) else []
    if len(needed) == len(problem.goals):
        return None
    alone = problem.with_goals(needed, add=False)
    return alone if (held_by_newton(alone) if needed else is_held_all_round(alone)) else None


def held_to_goals(problem: CGCProblem, alone: CGCProblem, solve: Callable[[CGCProblem], Solution]) -> Solution:
    """Return the surface over a rim that is held all round, not converged where it misses a goal.

    Parameters
    ----------
    problem
        With all goals.
    alone
        The same with those alone that are :func:`determining` it.
    solve
        Solves a problem.
    """
    drawn = solve(alone)
    missed = missed_goal(problem, drawn)
    if missed is not None and not isinstance(missed.goal, Bound):
        # Limits say nothing of a side, but a rise may be meant downwards.
        other = solve(alone.with_opposite_normals())
        if other.is_fair and missed_goal(problem, other) is None:
            drawn, missed = other, None
    if not drawn.is_fair:
        return drawn
    if missed is None:
        return drawn._replace(message=joined([drawn.message, HELD]))
    words = joined([missed.words, _met_by(problem, missed.goal, solve)], "")
    return drawn._replace(status="infeasible", message=joined(["infeasible: ", words], ""), verdict=None)


class _Missed(NamedTuple):
    """A goal that is not met."""

    goal: Constraint
    words: str


def _met_by(problem: CGCProblem, goal: Constraint, solve: Callable[[CGCProblem], Solution]) -> str:
    """Return the sentence on the K that meets a goal for one number of the whole surface, empty where there is none."""
    if not isinstance(goal, Whole):
        return ""
    found = solve(problem.with_goals([goal, Unknown()], add=False))
    if not found.is_fair or found.targets is None:
        return ""
    K = float(f"{found.targets[problem.asked][0]:.3g}")
    return Sentence(f"; K = {K:.3g} meets this goal", [Remedy("targets", K)])


def missed_goal(problem: CGCProblem, solution: Solution, within: float = DRAWING_ACCURACY) -> Optional[_Missed]:
    """Return the first goal that a surface misses by more than a part of its number or of the size, None where all are met."""
    size = float(np.ptp(problem.vertices, axis=0).max())
    for goal in problem.goals:
        away = _away(problem.with_goals([goal], add=False), solution.vertices, size)
        if away > within:
            return _Missed(goal, _words(solution.with_found(problem), goal, solution.vertices, away * size))
    return None


def _away(problem: CGCProblem, vertices: FloatArray, size: float) -> float:
    """Return how far a surface (n, 3) is from meeting goals, against their numbers or the size of the mesh."""
    goals, held = bind(problem), problem.vertices[~problem.movable]
    away = [0.0, float(np.linalg.norm(vertices[~problem.movable] - held, axis=1).max(initial=0.0)) / size]
    away += [abs(own.value(vertices) - own.wanted) / max(abs(own.wanted), abs(own.value(vertices))) for own in goals.equations]
    away += [-float(side.goal.slack(vertices[side.candidates(problem.vertices)])[0].min(initial=0.0)) / size for side in goals.sides]
    for place in goals.places:
        points = vertices[np.asarray(place.vertices, dtype=np.int64)]
        away.append(float(np.linalg.norm(place.closest_points(points).points - points, axis=1).max(initial=0.0)) / size)
    return max(away)


def _words(problem: CGCProblem, goal: Constraint, vertices: FloatArray, distance: float) -> str:
    """Return the sentence on a goal that a surface (n, 3) misses."""
    determined = DETERMINED.format(float(problem.targets[problem.asked].max()))
    find = FIND if isinstance(goal, (Whole, Height)) else ""
    if not has_number(goal):
        return joined([f"{determined}; it misses ", goal_name(goal), f" by {distance:.4g}; ", find, MEND], "")
    had = number_had(problem, goal, vertices)
    return joined([f"{determined}, with {had:.6g} instead of ", goal_name(goal), "; ", find, MEND], "")
