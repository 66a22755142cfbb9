"""A start for irregular and fine meshes: the surface on another mesh of the same drawing, carried over."""

from __future__ import annotations

import math
from typing import Callable
from typing import Optional

from ..discrete.smooth_measure import is_regular
from ..model.problem import CGCProblem
from ..model.recorder import Callback
from ..model.result import Solution
from ..model.result import SolveState
from ..model.verdict import verdict
from .coarse import Coarse
from .coarse import laid_out_anew
from .projection.projector import Projector

__all__ = ["MANY", "solved_anew"]

FEWEST, MOST = 200, 3000  # vertices: with fewer the shape of the plan is lost, and with more it takes minutes
MANY, COARSER = 1000, 4  # vertices of a regular one that has a coarser one by so much: waves that a search puts into it have no room there


def solved_anew(
    problem: CGCProblem, solve: Callable[[CGCProblem], Solution], freed: Callable[[CGCProblem], Solution], callback: Callback = None
) -> Optional[Solution]:
    """Return the solution from the surface that a problem has on a mesh laid out anew.

    Angle defects hold an irregular mesh so tightly, where K < 0 above all, that a search wrinkles it on its way. On near-regular
    triangles it does not, and from the smooth shape that it comes to the irregular mesh needs to be moved by little. A regular mesh that
    a search gets lost on has a coarser one for that.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets.
    solve
        Solves the problem with that surface drawn.
    freed
        The same, with vertices that may leave it: where it is fairer than what stretched triangles make of it.
    callback
        Called after every step on the other mesh, with the shape carried over.

    Returns
    -------
    Solution or None
        None where there is no such other mesh, or no surface on it.
    """
    count = len(problem.vertices)
    if problem.goals or count > MOST:
        return None
    regular = is_regular(problem.faces, problem.asked)
    if regular and count < MANY:
        return None
    anew = laid_out_anew(problem, count // COARSER if regular else max(FEWEST, count))
    if anew is None:
        return None
    solution = Projector(anew.problem).solve(callback=_carried(anew, callback))
    carried = anew.carried(solution.vertices)
    if solution.status == "cancelled":
        return solution._replace(vertices=carried)
    if solution.status != "converged":
        return None
    drawn = problem.with_vertices(carried)
    kept = solve(drawn)
    roughness = _roughness(problem, kept)
    if kept.status == "cancelled" or roughness <= _roughness(anew.problem, solution):
        return kept
    other = freed(drawn)
    return other if other.status == "cancelled" or _roughness(problem, other) < roughness else kept


def _roughness(problem: CGCProblem, solution: Solution) -> float:
    """Return that of the verdict, 0 of a fair surface and infinite where the equations are not met."""
    if solution.status != "converged":
        return math.inf
    judged = verdict(problem.with_vertices(solution.vertices), problem.vertices)
    return 0.0 if judged.fair else judged.roughness


def _carried(anew: Coarse, callback: Callback) -> Callback:
    if callback is None:
        return None

    def told(state: SolveState) -> object:
        return callback(state._replace(vertices=anew.carried(state.vertices)))

    return told
