"""The choice of a method: the first that suits the problem, and others when it stalls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete import boundary_vertices
from ..model.constraints import Constraint
from ..model.problem import CREASE
from ..model.problem import FIXED
from ..model.problem import CGCProblem
from ..model.result import Solution
from .registry import SETTINGS
from .registry import Callback
from .registry import Settings
from .registry import run

__all__ = ["Choice", "choose", "run_auto"]


class Choice(NamedTuple):
    """A method and why."""

    method: str
    reason: str


def choose(problem: CGCProblem, settings: Optional[Settings] = None, constrained: bool = False) -> list[Choice]:
    """Return the methods to try, the best first.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets.
    settings
        Settings of a method choose that method.
    constrained
        Whether there are constraints besides K.
    """
    for method, kind in SETTINGS.items():
        if isinstance(settings, kind):
            return [Choice(method, f"its settings were given ({kind.__name__})")]
    targets = problem.targets[problem.asked]
    if constrained:
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
    return [Choice("projection", "it finds the fair surface nearest to the mesh, with free edges and creases, for any K̄"), flow]


def run_auto(
    problem: CGCProblem,
    settings: Optional[Settings] = None,
    constraints: Sequence[Constraint] = (),
    callback: Callback = None,
) -> Solution:
    """Solve by the first method that arrives; else return the surface nearest to its targets.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets.
    settings
        Of one of the methods, which is then the one to use.
    constraints
        What is asked besides K.
    callback
        Called after every step of every method that is tried.
    """
    tried: list[tuple[Solution, Choice]] = []
    for choice in choose(problem, settings, bool(constraints)):
        solution = run(choice.method, problem, settings, constraints, callback)
        tried.append((solution, choice))
        if solution.status in ("converged", "infeasible", "cancelled"):
            break
    if tried[-1][0].status in ("converged", "infeasible", "cancelled"):
        solution, choice = tried[-1]
    else:
        solution, choice = min(tried, key=lambda pair: pair[0].max_error)
    before = [f"{other.method} {said.status}" for said, other in tried if other is not choice]
    text = f"{choice.method}, as {choice.reason}: {solution.message}"
    if before:
        text += f" ({', '.join(before)})"
    return solution._replace(message=text)
