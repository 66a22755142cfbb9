"""What supports can carry: the largest targets that a fair surface has, found by letting them grow."""

from __future__ import annotations

import math
from dataclasses import asdict
from dataclasses import dataclass
from typing import Optional

import numpy as np

from ..errors import ProblemError
from ..errors import Sentence
from ..errors import names_what_was_meant
from ..errors import scaled
from ..linalg.work import Work
from ..model.given import checked_number
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from ..model.problem import problem_of
from ..model.verdict import Verdict
from .branch_ends import ENDS
from .coarse import coarsened
from .constants import EVEN_VERTICES
from .constants import LARGE_MESH
from .constants import MEDIUM_MESH
from .projection.drawing import as_meant
from .rising import GROWTH
from .rising import Bracket
from .rising import Rising

__all__ = ["SOLVES", "TOLERANCE", "Limit", "largest_target", "raised"]

TOLERANCE = 0.01  # width of the interval around a limit, relative to the limit; two digits, so that every door states the same number
# surfaces that are solved for at most; twelve for growth and halving, thrice as many where a branch loses its symmetry in small steps
SOLVES = 40
# smallest rejected factor over the largest accepted one, up to which no "or more" is added; a search that runs out of work is wider
SURELY = 1.15


@dataclass(frozen=True)
class Limit:
    """The largest targets that supports carry, all in the ratio asked for."""

    status: str  # "found", "open" where no end was met, or "none" where not the least was carried
    factor: float  # on the targets asked for; 0 where none
    target: float  # the K̄ of the largest magnitude that is carried [1/L^2]
    beyond: Optional[float]  # the smallest that was tried and not carried, None where none was [1/L^2]
    message: str  # one sentence
    verdict: Optional[Verdict]  # on the surface at the limit
    solves: int
    coarser: bool = False  # whether that is so on a coarser mesh of the same drawing, not on the mesh itself
    end: str = ""  # what ends their branch: fold, bifurcation, rough or plan; empty where that is not known

    @property
    def carries_what_is_asked(self) -> bool:
        """Whether the targets are within the limit."""
        return self.factor >= 1.0

    def __str__(self) -> str:
        return self.message

    def to_dict(self) -> dict:
        """Return plain data, ready for JSON."""
        return {**asdict(self), "verdict": None if self.verdict is None else self.verdict.to_dict()}


@names_what_was_meant()
def largest_target(
    posed: PosesProblem, *, tolerance: float = TOLERANCE, solves: int = SOLVES, vertices: int = MEDIUM_MESH, work: Optional[Work] = None
) -> Limit:
    """Return how large the targets can be for a fair surface over the supports as they are.

    All targets are multiplied by one factor: with K̄ > 0 it leads to the largest, with K̄ < 0 to the smallest. From a
    gentle surface on they grow, each solved from the last; where one does not converge or is rough the interval is
    halved. Of large meshes a coarser one of the same drawing is searched first, and what that carries is looked for on the mesh itself.

    Parameters
    ----------
    posed
        A problem, or a mesh, with supports and targets, which say the ratio of the regions and the signs.
    tolerance
        Width of the interval around the limit to stop at, against the limit.
    solves
        Most surfaces to solve for.
    vertices
        Of a larger mesh the search begins on a coarser one.
    work
        That the search may take; what is carried by then is returned. Default: any.

    Returns
    -------
    Limit

    Raises
    ------
    ProblemError
        If no target is set, or all are zero; or nothing holds the mesh.

    Examples
    --------
    >>> from compas_cgc.datastructures import CGCMesh
    >>> mesh = CGCMesh.from_meshgrid(dx=1, nx=8)
    >>> mesh.set_supports("boundary")
    >>> mesh.set_target(1.0)
    >>> limit = largest_target(mesh)
    >>> limit.status, bool(1.5 < limit.target < 3.2)
    ('found', True)
    """
    tolerance = checked_number(tolerance, "tolerance")
    problem = problem_of(posed, "has limits").without_dummies()
    return raised(problem, tolerance=tolerance, solves=solves, vertices=vertices, work=work)


def raised(
    problem: CGCProblem,
    *,
    tolerance: float,
    solves: int,
    vertices: int,
    work: Optional[Work] = None,
    most: float = math.inf,
) -> Limit:
    """Return how large the targets of a problem can be.

    What a coarser mesh carries is looked for again on the mesh itself, from its surface.

    Parameters
    ----------
    problem, tolerance, solves, vertices, work
        As for :func:`largest_target`.
    most
        Factor on the targets that is enough.

    Raises
    ------
    ProblemError
        If no target is set, or all are zero; or nothing holds the mesh.
    """
    targets = problem.targets[problem.asked]
    if not len(targets) or not np.isfinite(targets).all() or not targets.any():
        raise ProblemError(
            ["the largest target can be searched only from a target other than zero; set one (mesh.set_target(K), or --target K)"]
        )
    count, work = len(problem.vertices), work or Work(math.inf)
    # Spikes of columns that were pulled out of a sheet hide its plan.
    drawn = as_meant(problem)
    coarse = coarsened(drawn, min(vertices, EVEN_VERTICES)) if count > vertices else None
    if coarse is None:
        rising = Rising(problem, tolerance, solves, work, most)
        bracket = rising.narrowed(rising.begun())
        if bracket.carried is not None or rising.over:
            return _told(problem, bracket, rising.count)
        # Where it is the layout of the mesh that is rough, one laid out anew tells what the supports can carry.
        coarse = coarsened(drawn, count // 2)
        if coarse is None:
            return _told(problem, bracket, rising.count)
    elsewhere = Rising(coarse.problem, tolerance, solves, work, most)
    bracket = elsewhere.narrowed(elsewhere.begun())
    if bracket.carried is None or count > LARGE_MESH:
        return _told(problem, bracket, elsewhere.count, coarser=True)
    rising = Rising(problem, tolerance, solves, work, most, elsewhere.ways)
    falling = sorted(elsewhere.trail, key=lambda one: -one.factor)
    here = rising.near((one.factor, coarse.carried(one.vertices)) for one in falling)
    if here.carried is None:
        return _told(problem, bracket, elsewhere.count + rising.count, coarser=True)
    growth = min(GROWTH, max(1.0 + tolerance, (bracket.beyond or math.inf) / here.carried.factor))
    return _told(problem, rising.narrowed(here, growth), elsewhere.count + rising.count)


def _told(problem: CGCProblem, bracket: Bracket, solves: int, coarser: bool = False) -> Limit:
    targets = problem.targets[problem.asked]
    largest = float(targets[np.argmax(np.abs(targets))])
    several = bool(np.ptp(targets))
    carried, beyond, end = bracket
    if carried is None:
        least = largest * (beyond or 0.0)
        return Limit("none", 0.0, 0.0, least, _none(least), None, solves)
    message = _found(largest, carried.factor, beyond, end, several, coarser)
    status = "open" if beyond is None else "found"
    return Limit(
        status,
        carried.factor,
        largest * carried.factor,
        None if beyond is None else largest * beyond,
        message,
        carried.judged,
        solves,
        coarser,
        end,
    )


def _found(largest: float, factor: float, beyond: Optional[float], end: str, several: bool, coarser: bool) -> str:
    carried = largest * factor
    bound = "up to" if largest > 0 else "down to"
    what = f"{factor:.3g} times the targets, that is, |K̄| up to {abs(carried):.4g}" if several else f"K̄ {bound} {carried:.4g}"
    asked = "" if several else f", {factor:.3g} times the target" if factor >= 1.0 else f"; the target is {largest:.4g}"
    surely = beyond is not None and beyond <= SURELY * factor
    more = "" if surely else " or more"
    why = f", because {ENDS[end]}" if end else ""
    least = f" (none was found for {beyond * (1.0 if several else largest):.4g}{why})" if beyond is not None and beyond != 1.0 else ""
    where = " on a coarser mesh" if coarser else ""
    text = f"over these supports, fair surfaces were found for {what}{more}{where}{least}{asked}"
    return Sentence(text, [scaled(factor)] if factor < 1.0 else [])


def _none(tried: float) -> str:
    return (
        f"no fair surface was found over these supports, not even for K̄ = {tried:.3g}; free an edge, move the supports or "
        "draw creases between them"
    )
