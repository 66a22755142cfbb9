"""Validation of solved surfaces for fabrication."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Optional

import numpy as np

from ..discrete import angle_defects
from ..discrete import vertex_areas
from ..errors import CGCError
from ..model.given import no_region
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from ..model.problem import problem_of
from ..model.verdict import verdict
from .option_values import region_numbers

__all__ = ["chosen_regions", "solved_problem"]

MAX_TOTAL_ERROR = 0.1  # relative error of the total curvature above which a rough surface counts as unsolved
FLAT_CURVATURE = 1e-9  # total curvature below which a surface counts as flat


def solved_problem(surface: PosesProblem, rough: bool = False) -> CGCProblem:
    """Return the problem of a surface without dummies; refuse rough surfaces unless `rough` is true.

    Raises
    ------
    CGCError
        If there are no faces, or the surface is unsolved or rough.
    """
    problem = problem_of(surface, "or the result of a solve is built from").without_dummies()
    if not len(problem.faces):
        raise CGCError("the mesh has no faces; give a mesh with faces")
    if not rough and np.isfinite(problem.targets[problem.asked]).any():
        judged = verdict(problem)
        reached = _reached(problem)
        if not judged.fair and abs(reached - 1.0) > MAX_TOTAL_ERROR:
            raise CGCError(
                f"the surface is rough because it is not solved: its total curvature is {round(100 * reached)} % of the target; "
                "solve it first and use the result"
            )
        if not judged.fair:
            raise CGCError(f"the surface is {judged}; solve it again, or accept rough surfaces (rough=True)")
    return problem


def chosen_regions(problem: CGCProblem, regions: Optional[Iterable[int]]) -> list[int]:
    """Return the chosen regions, sorted and without duplicates; all by default.

    Raises
    ------
    CGCError
        If a region does not exist.
    """
    count = len(problem.region_targets())
    if regions is None:
        return list(range(count))
    given: object = regions
    named = region_numbers(list(given) if isinstance(given, Iterable) and not isinstance(given, str) else given, "regions")
    wrong = [region for region in named if not 0 <= region < count]
    if wrong:
        raise CGCError(no_region(wrong[0], count, bool(len(problem.creases))))
    return sorted(set(named))


def _reached(problem: CGCProblem) -> float:
    """Return the total curvature of vertices with a target over its target value; 1 if that is zero.

    All measures of K agree on the total.
    """
    K, areas = problem.targets[problem.asked], vertex_areas(problem.vertices, problem.faces)[problem.asked]
    known = np.isfinite(K)
    asked = float(np.abs(K[known]) @ areas[known])
    found = float(np.sign(K[known]) @ angle_defects(problem.vertices, problem.faces)[problem.asked][known])
    return found / asked if asked > FLAT_CURVATURE else 1.0
