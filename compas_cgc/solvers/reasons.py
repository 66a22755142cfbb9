"""Why a problem has no fair surface, as far as that can be found soon."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..discrete.local_fits import local_fits
from ..errors import ProblemError
from ..linalg.work import Work
from ..model.bulging import two_sided_supports
from ..model.goals.binding import bind
from ..model.goals.binding import unknown_regions
from ..model.goals.inequalities import Bound
from ..model.goals.places import EdgeInPlan
from ..model.goals.places import Level
from ..model.goals.wholes import Whole
from ..model.inward_edges import inward_edges
from ..model.problem import CGCProblem
from .limits import largest_target
from .projection.plate import relaxed
from .projection.symmetry import tears_faces

__all__ = ["why_not_found", "why_rough"]

ROUGHLY, FEW, SMALL = 0.05, 12, 500  # tolerance, solves and vertices of a search for what could be carried
SEARCH = 5e6  # right sides times unknowns that it may take, under two seconds
FEWER = 8  # solves where goals make each longer
LARGE = 2000  # vertices of a problem with goals above which there is no such search
NOTHING = "no fair surface was found over these supports with these goals, not even for a small part of K̄; ask for less of them"

LAYOUT = (
    "times what is asked with a fair surface, on a coarser mesh where this one is large or rough; "
    "so mesh the drawing anew with fewer, even triangles, or draw it nearer to the surface"
)


def why_not_found(problem: CGCProblem, status: str, columns: Callable[[], str] = str) -> str:
    """Return why no surface was found, or how much of the targets the supports carry, after a semicolon; empty where that is not known.

    The columns that are in the way are looked for where supports by themselves contradict nothing.
    """
    whole = bind(problem).whole if problem.constraints else False
    if status not in ("stalled", "diverged") and not (status == "infeasible" and whole):
        return ""
    if tears_faces(problem):
        return ""  # The message blames the mesh: the supports may carry it.
    if problem.constraints and not whole:
        return _after(columns() or _carried(problem))
    return _after(_contradiction(problem) or columns() or _carried(problem))


def why_rough(problem: CGCProblem, columns: Callable[[], str] = str) -> str:
    """Return why the surface is rough, or how much of the targets the supports carry, after a semicolon; empty where not known."""
    asking = any(isinstance(own, (Bound, Whole, EdgeInPlan, Level)) for own in problem.constraints)
    return _after(_contradiction(problem) or columns() or _carried(problem, NOTHING if asking else "", LAYOUT))


def _after(said: str) -> str:
    return f"; {said}" if said else ""


def _contradiction(problem: CGCProblem) -> str:
    """Return the sentence on supports that no surface with K > 0 passes through."""
    real = problem.without_dummies()
    return next(iter(two_sided_supports(real) or inward_edges(real)), "")


def _carried(problem: CGCProblem, nothing: str = "", enough: str = "") -> str:
    """Return the sentence on the largest targets that are carried, where that is found soon; others where none are, or what is asked."""
    targets = problem.targets[problem.asked]
    known = len(targets) and np.isfinite(targets).all() and not unknown_regions(problem)
    if not known or (problem.constraints and len(problem.vertices) > LARGE):
        return ""
    if not targets.any():
        return "" if problem.constraints else _far_from_developable(problem)
    try:
        solves = FEWER if problem.constraints else FEW
        work = None if problem.constraints else Work(SEARCH)
        limit = largest_target(problem, tolerance=ROUGHLY, solves=solves, vertices=SMALL, work=work)
    except ProblemError:  # What the goals name is not on a coarser mesh.
        return ""
    if limit.status == "none":
        return nothing or limit.message
    if not limit.carries_what_is_asked:
        return limit.message
    return "" if problem.constraints or not enough else f"by steps from smaller targets these supports carry {limit.factor:.3g} {enough}"


def _far_from_developable(problem: CGCProblem) -> str:
    """Return the sentence on K = 0 over supports that bend a surface both ways."""
    real = problem.without_dummies()
    shape = relaxed(real)
    K = local_fits(shape, real.faces, real.asked, real.asked).gaussian
    K = K[np.isfinite(K)]
    if not len(K):
        return ""
    low, high = np.percentile(K, [10, 90]).tolist()
    return (
        f"the surface that bends least over these supports has K from {low:.2g} to {high:.2g}, and one of K = 0 is straight one way from "
        "edge to edge: hold it along two curves or fewer points and let the other edges go free, or lead creases between them"
    )
