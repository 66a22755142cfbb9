"""Solved surfaces: what all of fabrication starts from."""

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

ASTRAY = 0.1  # part of the total curvature asked for that a rough surface which has been solved may be off by
FLAT = 1e-9  # total curvature below which a surface counts as flat


def solved_problem(surface: PosesProblem, rough: bool = False) -> CGCProblem:
    """Return the problem of a surface without dummies, refused when the surface is rough and targets are known.

    Raises
    ------
    CGCError
        If there are no faces, or the surface is not solved, or rough, and rough ones are not wanted.
    """
    problem = problem_of(surface, "or the result of a solve is built from").without_dummies()
    if not len(problem.faces):
        raise CGCError("there are no faces to build from; give a mesh with some")
    if not rough and np.isfinite(problem.targets[problem.asked]).any():
        judged = verdict(problem)
        reached = _reached(problem)
        if not judged.fair and abs(reached - 1.0) > ASTRAY:
            raise CGCError(
                f"the surface is rough, as it is not solved: in all it has {round(100 * reached)} % of the curvature asked for; "
                "solve it first, and build from the result"
            )
        if not judged.fair:
            raise CGCError(f"the surface is {judged}; solve it (again) before it is built, or allow rough surfaces")
    return problem


def chosen_regions(problem: CGCProblem, regions: Optional[Iterable[int]]) -> list[int]:
    """Return the regions that are to be taken, each once and in order; all where none are named.

    Raises
    ------
    CGCError
        If there is no such region.
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
    """Return the total curvature of the vertices with a target against what is asked for; 1 where that is none.

    Every measure of K agrees on the total, however the faces lie.
    """
    K, areas = problem.targets[problem.asked], vertex_areas(problem.vertices, problem.faces)[problem.asked]
    known = np.isfinite(K)
    asked = float(np.abs(K[known]) @ areas[known])
    found = float(np.sign(K[known]) @ angle_defects(problem.vertices, problem.faces)[problem.asked][known])
    return found / asked if asked > FLAT else 1.0
