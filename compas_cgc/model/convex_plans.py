"""Convex plans, over which K > 0 is bounded."""

from __future__ import annotations

import math
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..meshing import boundary_loops
from ..meshing.existence import is_plane_and_convex
from .laws import types_of
from .problem import CGCProblem

__all__ = ["beyond_convex_plans"]


def beyond_convex_plans(problem: CGCProblem, drawn: Optional[FloatArray] = None) -> list[str]:
    r"""Return a sentence for every region whose K > 0 no smooth surface over its plan has, although the mesh may.

    A surface with K > 0 over a convex plan is convex, so that its slopes p differ everywhere, and

    .. math:: \int K \, dA_{plan} = \int \frac{dp}{(1 + |p|^2)^2} < \pi,

    whatever holds it. Coarse meshes do not see that.

    Parameters
    ----------
    problem
        A surface with its targets.
    drawn
        ``(n, 3)`` the drawing, whose mean normal is the direction of the plan [L]. Default: the surface.
    """
    V, F, regions = problem.vertices, problem.faces, problem.regions()
    whole = _area_vectors(V if drawn is None else drawn, problem).sum(axis=0)
    size = float(np.linalg.norm(whole))
    if not size > 0.0:
        return []
    up = whole / size
    plan, targets, of_regions = _area_vectors(V, problem) @ up, problem.face_targets(), problem.region_targets()
    flat = V - (V @ up)[:, None] * up
    found = []
    for region in np.unique(regions).tolist():
        own = regions == region
        K, area = of_regions[region], float(plan[own].sum())
        total = float(targets[own] @ plan[own]) if K is None else K * area
        if not (total >= math.pi and (types_of(targets[own]) > 0).all() and (plan[own] > 0.0).all()):
            continue
        loops = boundary_loops(F[own])
        if len(loops) == 1 and is_plane_and_convex(flat[loops[0]]):
            where = f"the convex plan of region {region}" if len(np.unique(regions)) > 1 else "this convex plan"
            found.append(f"no surface over {where} has K = {math.pi / area:.4g} or more (set a smaller K, or draw creases)")
    return found


def _area_vectors(vertices: FloatArray, problem: CGCProblem) -> FloatArray:
    a, b, c = (vertices[problem.faces[:, k]] for k in range(3))
    return np.asarray(0.5 * np.cross(b - a, c - a))
