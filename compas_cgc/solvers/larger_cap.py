"""The larger of the two surfaces that K > 0 has over a closed rim, as the rest of a sphere is to its cap."""

from __future__ import annotations

import math

import numpy as np

from ..discrete import angle_defects
from ..discrete import boundary_vertices
from ..discrete import face_areas
from ..discrete import vertex_areas
from ..discrete.normals import face_normals
from ..model.problem import CGCProblem
from ..model.recorder import Callback
from ..model.result import Solution
from .polish.polisher import polish
from .rising import GROWTH

__all__ = ["with_larger_cap"]

# mean cosine of the face normals at the rim to the mean normal, below which a drawing is steep; 10° short of a half sphere
UPRIGHT = math.sin(math.radians(10.0))
ALSO = "result.branches has the larger surface over the same rim"


def with_larger_cap(problem: CGCProblem, solution: Solution, callback: Callback = None) -> Solution:
    """Return a solution with the larger surface over the same rim in its branches, where a drawing stands upright on it.

    Among the graphs over a plan the surface with K > 0 is unique. The other one overhangs its rim, and so only a drawing that is as
    steep as a half sphere there leads to it: across the drawing from the surface that was found, then on to smaller K.

    Parameters
    ----------
    problem
        With the vertices of the drawing, held all round, with K > 0.
    solution
        A fair surface.
    callback
        Called after every step, with the vertices of the solution.
    """
    if problem.goals or solution.branches[1:] or not _stands_upright(problem):
        return solution
    shown = callback and (lambda state: callback(state._replace(vertices=solution.vertices)))
    larger = problem.with_vertices(2.0 * problem.vertices - solution.vertices)
    factor = max(1.0, _total_curvature(problem) / GROWTH)
    while True:
        found = polish(larger.with_targets(factor * problem.targets), start=larger.vertices, callback=shown)
        if not found.is_fair:
            return solution
        larger = problem.with_vertices(found.vertices)
        if factor == 1.0:
            break
        factor = max(1.0, factor / GROWTH)
    areas = [float(face_areas(vertices, problem.faces).sum()) for vertices in (found.vertices, problem.vertices, solution.vertices)]
    if areas != sorted(areas, reverse=True):
        return solution
    smaller = polish(problem.with_vertices(solution.vertices), start=solution.vertices, callback=shown)
    if not smaller.branches:
        return solution
    own = smaller.branches[0]._replace(vertices=solution.vertices, fair=True)
    return solution._replace(branches=(own, found.branches[0]), message=f"{solution.message}; {ALSO}")


def _stands_upright(problem: CGCProblem) -> bool:
    """Return whether the faces along the rim of a drawing stand upright on its plane, or overhang it."""
    normals, areas = face_normals(problem.vertices, problem.faces), face_areas(problem.vertices, problem.faces)
    up = areas @ normals
    rim = boundary_vertices(problem.vertices, problem.faces)[problem.faces].sum(axis=1) >= 2
    return float(np.average(normals @ up, weights=rim * areas)) <= UPRIGHT * float(np.linalg.norm(up))


def _total_curvature(problem: CGCProblem) -> float:
    """Return the total curvature of a drawing against that of its targets."""
    asked = problem.asked
    total = problem.targets[asked] @ vertex_areas(problem.vertices, problem.faces)[asked]
    return float(angle_defects(problem.vertices, problem.faces)[asked].sum() / total)
