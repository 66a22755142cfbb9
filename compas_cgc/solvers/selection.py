"""The choice of a method: the first that suits the problem, and others when it stalls."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete import boundary_vertices
from ..model.problem import CGCProblem
from ..model.recorder import Callback
from ..model.result import Solution
from ..model.roles import CREASE
from ..model.roles import FIXED
from .method import Method
from .registry import METHODS
from .registry import method_of
from .registry import settings_of
from .settings import Settings

__all__ = ["Choice", "choose", "run_auto", "run_method"]

OVER = ("converged", "infeasible", "cancelled")  # statuses after which nothing else is tried


class Choice(NamedTuple):
    """A method and why."""

    method: str
    reason: str


def choose(problem: CGCProblem, settings: Optional[Settings] = None) -> list[Choice]:
    """Return the methods to try, the best first.

    Parameters
    ----------
    problem
        Vertices, faces, roles, targets and constraints.
    settings
        Settings of a method choose that method.
    """
    if settings is not None and method_of(settings) != "auto":
        return [Choice(method_of(settings), f"its settings were given ({type(settings).__name__})")]
    choices = _choices(problem)
    if settings is None or settings.to_dict()["measure"] in ("auto", "defect"):
        return choices
    return [choice for choice in choices if "measure" in METHODS[choice.method].settings.options()]


def _choices(problem: CGCProblem) -> list[Choice]:
    targets = problem.targets[problem.asked]
    if problem.constraints:
        return [Choice("projection", "it alone holds constraints")]
    if (targets < 0).any():
        return [Choice("projection", "it alone reaches negative K̄")]
    strategies = np.isfinite(problem.s) | np.isfinite(problem.e)
    flow = Choice("flow", "the paper's flow reaches K̄ >= 0 from afar")
    if (strategies & (problem.roles == CREASE)).any():
        return [Choice("flow", "s or e are set on creases, strategies of the flow"), Choice("projection", "it needs no strategy")]
    rim = boundary_vertices(problem.vertices, problem.faces)
    held = (problem.roles[rim] == FIXED).all() and rim.any() and problem.real_faces.all()
    if held and not (problem.roles == CREASE).any() and targets.size and (targets > 0).all():
        return [
            Choice("newton", "the whole edge is fixed, there are no creases, and K̄ > 0"),
            Choice("projection", "it moves vertices sideways too"),
            flow,
        ]
    return [Choice("projection", "it finds the fairest surface, with free edges and creases, for any K̄"), flow]


def run_method(method: Method, problem: CGCProblem, *, settings: Optional[Settings] = None, callback: Callback = None) -> Solution:
    """Solve a problem by one method, see :class:`Method`."""
    return method.solve(problem, settings_of(method, settings), callback)._replace(method=method.name)


def run_auto(problem: CGCProblem, *, settings: Optional[Settings] = None, callback: Callback = None) -> Solution:
    """Solve by the first method that arrives; else return the surface nearest to its targets.

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
    for choice in choose(problem, settings):
        tried.append((run_method(METHODS[choice.method], problem, settings=settings, callback=callback), choice))
        if tried[-1][0].status in OVER:
            break
    solution, choice = tried[-1] if tried[-1][0].status in OVER else min(tried, key=lambda pair: pair[0].max_error)
    before = [f"{other.method} {said.status}" for said, other in tried if other is not choice]
    text = f"{choice.method}, as {choice.reason}: {solution.message}"
    if before:
        text += f" ({', '.join(before)})"
    return solution._replace(message=text)
