"""Checks of the laws of a problem: where no surface can obey them over its supports."""

from __future__ import annotations

import numpy as np

from ..discrete.arrays import IntArray
from ..meshing import Diagnostic
from ..meshing import boundary_loops
from ..meshing.existence import plane_of
from .goals.binding import finds_constants
from .goals.binding import unknown_regions
from .laws import Law
from .measures import has_free_edges
from .problem import CGCProblem
from .roles import FIXED
from .tolerances import DRAWING_ACCURACY

__all__ = ["law_problems"]


def law_problems(problem: CGCProblem) -> list[Diagnostic]:
    """Return what keeps regions with laws other than constant K from a surface."""
    if not problem.laws:
        return []
    problems = []
    regions, unknown = problem.regions(), unknown_regions(problem)
    # Within a held rim known laws leave goals no choice.
    sought = bool(unknown) or (bool(problem.goals) and not has_free_edges(problem))
    if sought and not finds_constants(problem):
        text = (
            "with laws other than constant K and without free edges, there can be only one height of a vertex or goal of the whole surface "
            "for each region with an unknown constant (unknown=[region], --unknown, or the goal Unknown); the constant "
            "in the drawing, such as 0.1 in H = 0.1, is the initial guess and must not be 0"
        )
        problems.append(Diagnostic(text))
    for region, law in problem.laws.items():
        if region in unknown:
            continue
        problems += _region_problems(problem, problem.faces[regions == region], region, law)
    return problems


def _region_problems(problem: CGCProblem, faces: IntArray, region: int, law: Law) -> list[Diagnostic]:
    loops = boundary_loops(faces)
    held = all((problem.roles[loop] == FIXED).all() for loop in loops)
    if not loops or not held:
        return []
    flat = np.zeros(1)
    if float(np.max(law.discriminant(flat, flat))) < 0.0:
        text = (
            f"region {region} has the hyperbolic law {law} and its whole boundary is supported; a hyperbolic law takes supports along a "
            "part of the boundary only: free one side of it, or release supports"
        )
        return [Diagnostic(text)]
    if len(loops) != 1 or plane_of(problem.vertices[loops[0]])[1] > DRAWING_ACCURACY:
        return []
    V = problem.vertices
    crosses = np.cross(V[faces[:, 1]] - V[faces[:, 0]], V[faces[:, 2]] - V[faces[:, 0]]).sum(axis=0)
    points = V[loops[0]]
    length = float(np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1).sum())
    impossible = law.excluded_within(length, 0.5 * float(np.linalg.norm(crosses)))
    return [Diagnostic(f"region {region} has no surface with {law} over its plane boundary: {impossible}")] if impossible else []
