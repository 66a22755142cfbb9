"""Solved surfaces: what all of fabrication starts from."""

from __future__ import annotations

import numpy as np

from ..errors import CGCError
from ..model.problem import CGCProblem
from ..model.problem import PosesProblem
from ..model.problem import problem_of
from ..model.verdict import verdict

__all__ = ["solved_problem"]


def solved_problem(surface: PosesProblem, rough: bool = False) -> CGCProblem:
    """Return the problem of a surface without dummies, refused when the surface is rough and targets are known.

    Raises
    ------
    CGCError
        If there are no faces, or the surface is rough and rough ones are not wanted.
    """
    problem = problem_of(surface, "or the result of a solve is built from").without_dummies()
    if not len(problem.faces):
        raise CGCError("there are no faces to build from; give a mesh with some")
    if not rough and np.isfinite(problem.targets[problem.asked]).any():
        judged = verdict(problem)
        if not judged.fair:
            raise CGCError(f"the surface is {judged}; solve it (again) before it is built, or allow rough surfaces")
    return problem
