"""What spheres over the plan have: an orientation where K is far too large, or far too small for a rise."""

from __future__ import annotations

import numpy as np

from ..errors import FOUND
from ..errors import Remedy
from ..errors import Sentence
from ..errors import joined
from ..model.goals.wholes import Rise
from ..model.problem import CGCProblem
from ..model.result import Solution

__all__ = ["cap_of_the_rise", "rounder_than_half_a_sphere", "with_half_a_sphere"]

# ratio of K to that of a cap with the drawn rise, beyond which units or rise are probably wrong; caps differ by less for any plan
OTHER = 4.0


def rounder_than_half_a_sphere(problem: CGCProblem) -> str:
    """Return the sentence on a K̄ beyond that of a half sphere over the smaller width of a plan; empty where it is not.

    Over a disk of the width w no surface has more than the half sphere's ``K = 4 / w^2``; with free edges some have a little
    more. Of regions between creases nothing is said, as each is narrower than the plan.

    Parameters
    ----------
    problem
        With the vertices of the drawing.

    Examples
    --------
    >>> from compas_cgc import CGCMesh
    >>> mesh = CGCMesh.from_meshgrid(dx=10.0, nx=10)
    >>> mesh.set_target(5.0)
    >>> rounder_than_half_a_sphere(mesh.to_problem())
    'K̄ = 5 is that of a sphere of radius 0.447, and a half sphere over the width of 10 has K = 0.04; choose a smaller K̄'
    """
    K = float(np.nan_to_num(problem.targets[problem.asked]).max(initial=0.0))
    if not (problem.types[problem.asked] > 0).any() or len(problem.creases):
        return ""
    width = _width(problem)
    if K * width**2 <= 4.0:
        return ""
    sphere = f"K̄ = {K:.4g} is that of a sphere of radius {K**-0.5:.3g}"
    return f"{sphere}, and a half sphere over the width of {width:.4g} has K = {4.0 / width**2:.4g}; choose a smaller K̄"


def with_half_a_sphere(problem: CGCProblem, solution: Solution) -> Solution:
    """Return a solution that did not arrive with that sentence at its end."""
    said = rounder_than_half_a_sphere(problem) if solution.status in ("stalled", "diverged") else ""
    return solution if not said or said in solution.message else solution._replace(message=joined([solution.message, said]))


def cap_of_the_rise(problem: CGCProblem) -> str:
    """Return which K a cap has that rises as high over the plan as is asked, where K̄ > 0 is far from it; else nothing.

    Parameters
    ----------
    problem
        With its goals, and the vertices of the drawing.
    """
    targets = problem.targets[problem.asked]
    rise = max((goal.rise for goal in problem.goals if isinstance(goal, Rise)), default=0.0)
    if not rise > 0.0 or len(problem.creases) or not (problem.types[problem.asked] > 0).all():
        return ""
    width = _width(problem)
    cap = (2.0 * rise / (0.25 * width**2 + rise**2)) ** 2
    if 1.0 / OTHER < float(np.median(targets)) / cap < OTHER:
        return ""
    text = (
        f"a cap that rises {rise:.4g} over the width of {width:.4g} has K = {cap:.2g}; use about this K, or let the solve "
        "determine K (unknown)"
    )
    return Sentence(text, [Remedy("targets", float(f"{cap:.2g}")), FOUND])


def _width(problem: CGCProblem) -> float:
    """Return the smallest width of the plan [L]."""
    from scipy.spatial import ConvexHull

    points = problem.without_dummies().vertices
    points = points - points.mean(axis=0)
    plan = points @ np.linalg.svd(points, full_matrices=False)[2][:2].T
    hull = plan[ConvexHull(plan).vertices]
    # The narrowest strip around a polygon lies along one of its edges.
    along = np.roll(hull, -1, axis=0) - hull
    across = np.column_stack([-along[:, 1], along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
    return float(np.ptp(hull @ across.T, axis=0).min())
