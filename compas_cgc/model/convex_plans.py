"""Convex plans, over which K > 0 is bounded."""

from __future__ import annotations

import math
from typing import Optional

import numpy as np

from ..discrete import _kernels
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
    whole = _kernels.cross_vectors(V if drawn is None else drawn, F).sum(axis=0)
    size = float(np.linalg.norm(whole))
    if not size > 0.0:
        return []
    up = whole / size
    plan = 0.5 * _kernels.cross_vectors(V, F) @ up
    areas = np.bincount(regions, plan)
    if np.nan_to_num(problem.targets[problem.asked]).max(initial=0.0) * areas.max(initial=0.0) < math.pi:
        return []
    targets = problem.face_targets()
    totals = np.bincount(regions, targets * plan)
    for region, K in enumerate(problem.region_targets()):
        totals[region] = totals[region] if K is None else K * areas[region]
    found = []
    for region in np.flatnonzero(totals >= math.pi).tolist():
        own = regions == region
        loops = boundary_loops(F[own])
        bulges = (types_of(targets[own]) > 0).all() and (plan[own] > 0.0).all()
        if bulges and len(loops) == 1 and is_plane_and_convex(V[loops[0]] - (V[loops[0]] @ up)[:, None] * up):
            where = f"the convex plan of region {region}" if len(areas) > 1 else "this convex plan"
            found.append(f"no surface over {where} has K = {math.pi / areas[region]:.4g} or more (set a smaller K, or draw creases)")
    return found
