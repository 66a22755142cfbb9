"""What supports can carry: the largest targets that a fair surface has, found by letting them grow."""

from __future__ import annotations

import math
from dataclasses import asdict
from dataclasses import dataclass
from dataclasses import replace
from typing import Callable
from typing import Optional

import numpy as np

from ..discrete import boundary_vertices
from ..discrete import face_areas
from ..discrete.arrays import FloatArray
from ..errors import ProblemError
from ..errors import names_what_was_meant
from ..linalg.work import Work
from ..model.given import checked_number
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from ..model.problem import problem_of
from ..model.result import Solution
from ..model.roles import CREASE
from ..model.roles import FIXED
from ..model.verdict import Verdict
from ..model.verdict import verdict
from .coarse import coarsened
from .newton.settings import NewtonSettings
from .projection.settings import ProjectionSettings

__all__ = ["Limit", "is_held_all_round", "largest_target"]

FINE = 1200  # vertices above which the search is made on a coarser mesh of the same drawing
PART = 2 / 3  # of so many, its vertices
LOW = 0.5  # total curvature [rad] to begin with
LEAST = 1 / 64  # of that, below which there is none
GROWTH = 1.5  # of the targets from one to the next
HIGH = 8 * np.pi  # total curvature [rad] that is as good as any
STEPS = 60  # for one solve


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

    @property
    def carries_what_is_asked(self) -> bool:
        """Whether the targets are within the limit."""
        return self.factor >= 1.0

    def __str__(self) -> str:
        return self.message

    def to_dict(self) -> dict:
        """Return plain data, ready for JSON."""
        return {**asdict(self), "verdict": None if self.verdict is None else self.verdict.to_dict()}


@dataclass(frozen=True)
class _Carried:
    factor: float
    vertices: FloatArray
    judged: Verdict


@names_what_was_meant()
def largest_target(
    posed: PosesProblem, *, tolerance: float = 0.02, solves: int = 40, vertices: int = FINE, work: Optional[Work] = None
) -> Limit:
    """Return how large the targets can be for a fair surface over the supports as they are.

    All targets are multiplied by one factor: with K̄ > 0 it leads to the largest, with K̄ < 0 to the smallest. From a
    gentle surface on they grow, each solved from the last; where one does not converge or is rough the interval is
    halved. Large meshes are searched on a coarser one of the same drawing, so the limit is that of the supports.

    Parameters
    ----------
    posed
        A problem, or a mesh, with supports and targets, which say the ratio of the regions and the signs.
    tolerance
        Width of the interval around the limit to stop at, against the limit.
    solves
        Most surfaces to solve for.
    vertices
        Of a larger mesh the search is made on a coarser one.
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
    targets = problem.targets[problem.asked]
    if not len(targets) or not np.isfinite(targets).all() or not targets.any():
        raise ProblemError(["there is no limit to look for without targets other than zero; say what is asked (mesh.set_target(K))"])
    largest = float(targets[np.argmax(np.abs(targets))])
    several = bool((targets * largest < 0).any() or np.ptp(targets) > 0)
    coarse = coarsened(problem, round(PART * vertices)) if len(problem.vertices) > vertices else None
    work = Work(math.inf) if work is None else work
    limit = _search(problem if coarse is None else coarse.problem, largest, several, tolerance, solves, work)
    if limit.status == "none" and coarse is None and not work.spent:
        # Where it is the layout of the mesh that is rough, one laid out anew tells what the supports can carry.
        coarse = coarsened(problem, len(problem.vertices) // 2)
        return limit if coarse is None else _search(coarse.problem, largest, several, tolerance, solves, work)
    return limit


def _search(problem: CGCProblem, largest: float, several: bool, tolerance: float, solves: int, work: Work) -> Limit:
    solve = _solver(problem)
    count = 0

    def tried(factor: float, last: Optional[_Carried]) -> Optional[_Carried]:
        nonlocal count
        count += 1
        with work.counted():
            solution = solve(factor, None if last is None else last.vertices)
        if solution.status != "converged":
            return None
        shape = replace(problem, targets=factor * problem.targets, vertices=solution.vertices)
        judged = verdict(shape, problem.vertices)
        return _Carried(factor, solution.vertices, judged) if judged.fair else None

    total = abs(largest) * float(face_areas(problem.vertices, problem.faces).sum())
    factor = first = min(1.0, LOW / total)
    carried = tried(factor, None)
    while carried is None and factor > LEAST * first and not work.spent:
        factor /= 4.0
        carried = tried(factor, None)
    if carried is None:
        return Limit("none", 0.0, 0.0, largest * factor, _none(largest * factor), None, count)
    beyond: Optional[float] = None
    while count < solves and work.left >= 0.0 and (beyond is None or beyond - carried.factor > tolerance * carried.factor):
        if beyond is None and carried.factor * total > HIGH:
            break
        factor = GROWTH * carried.factor if beyond is None else 0.5 * (carried.factor + beyond)
        found = tried(factor, carried)
        if found is None and work.left < 0.0:
            break  # It was cut short, which tells nothing of the supports.
        carried, beyond = (found, beyond) if found is not None else (carried, factor)
    message = _found(largest, carried.factor, beyond, several)
    status = "open" if beyond is None else "found"
    return Limit(status, carried.factor, largest * carried.factor, beyond and largest * beyond, message, carried.judged, count)


def is_held_all_round(problem: CGCProblem) -> bool:
    """Return whether the whole rim is fixed, there are no creases, and all targets are positive."""
    rim = boundary_vertices(problem.vertices, problem.faces)
    held = bool((problem.roles[rim] == FIXED).all() and rim.any() and problem.real_faces.all())
    targets = problem.targets[problem.asked]
    return held and not bool((problem.roles == CREASE).any()) and bool(len(targets) and (targets > 0).all())


def _solver(problem: CGCProblem) -> Callable[[float, Optional[FloatArray]], Solution]:
    """Return what solves for a factor on the targets, from a shape (n, 3) if there is one."""
    if is_held_all_round(problem) and not problem.constraints:
        from .newton.normal_newton import newton

        def by_newton(factor: float, vertices: Optional[FloatArray]) -> Solution:
            own = replace(problem, targets=factor * problem.targets, vertices=problem.vertices if vertices is None else vertices)
            return newton(own, settings=NewtonSettings(steps=STEPS))

        return by_newton
    from .projection.projector import Projector

    cold = Projector(problem, settings=ProjectionSettings(steps=2 * STEPS))
    # Where the last surface does not lead on, no other start is asked: the limit is that of this branch.
    warm = Projector(problem, settings=ProjectionSettings(steps=STEPS, retry=False))

    def by_projection(factor: float, vertices: Optional[FloatArray]) -> Solution:
        return (cold if vertices is None else warm).solve(factor * problem.targets, vertices)

    return by_projection


def _found(largest: float, factor: float, beyond: Optional[float], several: bool) -> str:
    carried = largest * factor
    bound = "up to" if largest > 0 else "down to"
    what = f"{factor:.3g} times the targets, |K̄| up to {abs(carried):.4g}," if several else f"K̄ {bound} {carried:.4g}"
    asked = "" if several else f", {factor:.3g} times what is asked" if factor >= 1.0 else f"; {largest:.4g} is asked"
    if beyond is None:
        return f"these supports carry {what} with a fair surface and probably more{asked}"
    return f"these supports carry {what} with a fair surface{asked}"


def _none(tried: float) -> str:
    return (
        f"no fair surface was found over these supports, not even for K̄ = {tried:.3g}; free an edge, move the supports or "
        "lead creases between them"
    )
