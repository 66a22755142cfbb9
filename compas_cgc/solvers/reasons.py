"""Why a problem has no fair surface, as far as that can be found soon."""

from __future__ import annotations

from typing import Optional

import numpy as np

from ..discrete.local_fits import local_fits
from ..errors import COARSER
from ..errors import FINER
from ..errors import ProblemError
from ..errors import Sentence
from ..errors import use_method
from ..model.bulging import two_sided_supports
from ..model.divided import with_halved_edges
from ..model.flat_edges import saddle_in_flat_edge
from ..model.goals.binding import bind
from ..model.goals.binding import unknown_regions
from ..model.goals.inequalities import Bound
from ..model.goals.names import goal_name
from ..model.goals.names import listed
from ..model.goals.places import EdgeInPlan
from ..model.goals.places import Level
from ..model.goals.wholes import Whole
from ..model.inward_edges import inward_edges
from ..model.problem import CGCProblem
from ..model.stepped_edges import stepped_edges
from ..model.straight_edges import twisted_edges
from ..model.verdict import verdict
from .constants import MEDIUM_MESH
from .half_sphere import cap_of_the_rise
from .limits import SOLVES
from .limits import TOLERANCE
from .limits import raised
from .polish.polisher import polish
from .polish.posed import takes_goals
from .projection.symmetry import tears_faces
from .projection.system import relaxed

__all__ = ["DRAWN_IN", "contradiction", "why_not_found", "why_rough"]

DRAWN_IN = Sentence("with the method projection free edges may leave their drawn lines", [use_method("projection")])
NOTHING = Sentence("no fair surface was found over these supports with {}, not even for a small fraction of K̄; reduce {}")

HALF_AS_LONG = Sentence(
    "with edges half as long a fair surface with these targets was found over the same supports; mesh the drawing finer", [FINER]
)
LAYOUT = Sentence(
    "on a coarser mesh over the same supports, a fair surface with these targets was found in steps from smaller ones; "
    "mesh the drawing again with fewer, more regular triangles, or draw it closer to the surface",
    [COARSER],
)


def why_not_found(problem: CGCProblem, status: str, limited: bool) -> str:
    """Return why no surface was found, or how much of the targets the supports carry; empty where that is not known.

    Where the user limited the steps, more may find it.
    """
    whole = bind(problem).whole if problem.goals else False
    searched = ("stalled", "diverged") if limited else ("stalled", "diverged", "step_limit")
    if status not in searched and not (status == "infeasible" and whole):
        return ""
    if tears_faces(problem):
        return ""  # The message blames the mesh: the supports may carry it.
    if problem.goals and not whole:
        return _carried(problem) or _twist(problem)
    # That there is none with such a goal has been said, and how much of it can be had.
    return contradiction(problem) or _step(problem) or _carried(problem, None if whole else "") or _twist(problem)


def why_rough(problem: CGCProblem, over_lines: bool) -> str:
    """Return why a surface, whose free edges may be over their drawn lines, is rough, or how much of the targets the supports carry.

    Empty where that is not known.
    """
    asking = list(dict.fromkeys(goal_name(own) for own in problem.goals if isinstance(own, (Bound, Whole, EdgeInPlan, Level))))
    nothing = NOTHING.format(listed(asking), "it" if len(asking) == 1 else "them") if asking else ""
    known = contradiction(problem, over_lines) or _step(problem) or cap_of_the_rise(problem) or _twist(problem)
    return known or _finer(problem) or _carried(problem, nothing, LAYOUT)


def contradiction(problem: CGCProblem, over_lines: bool = False) -> str:
    """Return the sentence on supports that no surface with K of this sign passes through, empty without any."""
    real = problem.without_dummies()
    return next(iter(two_sided_supports(real, over_lines) or inward_edges(real) or saddle_in_flat_edge(real)), "")


def _step(problem: CGCProblem) -> str:
    """Return the sentence on a step of the held edges, which some surfaces take with a fold that nobody sees, empty without any."""
    return next(iter(stepped_edges(problem.without_dummies())), "")


def _twist(problem: CGCProblem) -> str:
    """Return the sentence on held edges that twist the surface otherwise than K does, empty without any."""
    return next(iter(twisted_edges(problem.without_dummies())), "")


def _finer(problem: CGCProblem) -> str:
    """Return the sentence on a mesh that is too coarse for a surface over these supports, empty where it is not, or not small."""
    real = problem.without_dummies()
    if 4 * len(real.vertices) > MEDIUM_MESH or real.laws or not takes_goals(real):
        return ""
    fine = with_halved_edges(real)
    found = polish(fine)
    shape = fine.with_vertices(found.vertices)
    return HALF_AS_LONG if found.status == "converged" and verdict(shape, fine.vertices).fair else ""


def _carried(problem: CGCProblem, nothing: Optional[str] = "", enough: str = "") -> str:
    """Return the sentence on the largest targets that are carried, where that is found soon; others where none are, or what is asked.

    Where none are and None is to be said of that, nothing is.
    """
    targets = problem.targets[problem.asked]
    known = len(targets) and np.isfinite(targets).all() and not unknown_regions(problem)
    if not known:
        return ""
    if not targets.any():
        return "" if problem.goals else _far_from_developable(problem)
    try:
        limit = raised(problem.without_dummies(), tolerance=TOLERANCE, solves=SOLVES, vertices=MEDIUM_MESH, most=1.0)
    except ProblemError:  # What the goals name is not on a coarser mesh.
        return ""
    if limit.status == "none":
        return "" if nothing is None else nothing or limit.message
    return enough if limit.carries_what_is_asked else limit.message


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
        f"the surface that bends least over these supports has K from {low:.2g} to {high:.2g}, but a surface of K = 0 consists of "
        "straight lines from edge to edge: support it along two curves or at fewer points and free the other edges, or "
        "draw creases between "
        "the supports"
    )
