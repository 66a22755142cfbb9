"""Faults that are visible at single places of a surface: points where K is far off, and dips below the supports."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial import QhullError

from ..discrete import boundary_vertices
from ..discrete import edge_faces
from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete.arrays import TINY
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.local_fits import local_fits
from ..discrete.measured_curvature import MeasuredCurvature
from ..discrete.topology import within_rings
from .goals.binding import bind
from .goals.places import Level
from .goals.wholes import Unknown
from .laws import types_of
from .problem import CGCProblem
from .roles import FIXED
from .roles import INTERNAL

__all__ = ["FINE_DEGREE", "FINE_RINGS", "PLAN_SHARE", "VISIBLE", "Points", "dip", "on_held_edges", "points"]

VISIBLE = np.radians(9.0)  # turn of the surface across a point that is visible [rad]; that across the tip of a cone whose defect is 0.02
FINE_DEGREE = 4  # degree of the second fits; cubic fits deviate by 10 to 30 % on exact pseudospheres with triangles of 3 : 1
FINE_RINGS = 3  # rings of the second fits; two rings have too few points for fourteen terms
HALF = 0.5  # relative error of K at a vertex above which the surface has another K there; the discretisation errs less on coarse meshes
NEAR = 2  # distance from a support within which the exact surface may be singular [edges]; curvature at a vertex reads two rings
# length of the mean normal over the area, above which a surface has a plan to bulge over; closed surfaces and tubes have 0
PLAN_SHARE = 0.25
DEEP = 0.1  # depth of a dip relative to the height of the surface over its supports; a tenth is visible in elevation
APEX = 1e3  # height of the point over supports whose lower hull is sought, relative to their extent; so high that no lower face meets it


class Points(NamedTuple):
    """Vertices where a surface comes to a point."""

    vertices: IntArray  # (k,)
    turns: FloatArray  # (k,) of the surface across them [rad]
    found: FloatArray  # (k,) K there [1/L^2]


def points(problem: CGCProblem, measured: MeasuredCurvature, least: FloatArray) -> Points:
    """Return the vertices, supports included, where K is far off, visibly or by its sign on most readings.

    The integral of K - K̄ over the cell of a vertex is that of a cone which turns by ``θ`` across its tip: ``π θ² / 4``. Up to
    two edges from supports, where the exact surface may be singular, a visible tip has K of the wrong sign, elsewhere K is off
    by more than half. What is not visible counts if mid-edge normals read the wrong sign, and so does the median with polynomials of two
    degrees: each errs on coarse meshes in its own way. On fixed edges, creases and free edges not all methods prescribe K, and up to two
    edges from fixed ones K is not judged where K̄ > 0: towards a straight fixed edge one principal curvature is unbounded, and on it
    K is not positive.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets, without dummies.
    measured
        Curvature of the surface by mid-edge normals.
    least
        ``(n,)`` smallest reference curvature for relative errors; less curvature than this is invisible [1/L^2].
    """
    at, region = measured.pairs.T
    cells = measured.areas / 3.0
    of_regions = np.array([np.nan if K is None else K for K in problem.region_targets()], dtype=np.float64)
    targets = np.where(problem.asked[at], problem.targets[at], of_regions[region])
    F, fixed, held = problem.faces, problem.roles == FIXED, on_held_edges(problem)
    near = within_rings(F, fixed, NEAR)
    unbounded = held | (within_rings(F, held, NEAR) & (problem.types > 0))
    if not fixed.any():
        # Of a surface alone it is unknown where it was supported.
        unbounded |= within_rings(F, boundary_vertices(problem.vertices, F), NEAR)
    missed = measured.gaussian - targets
    excess, half = np.abs(missed) * cells, HALF * np.abs(targets) * cells
    judged = (excess > half) & ~unbounded[at] & (problem.asked | fixed)[at]
    visible = (excess > half + np.pi / 4.0 * VISIBLE**2) & (~near[at] | (measured.gaussian * types_of(targets) < 0.0))
    # Polynomials read no bounded curvature where their rings reach edges at which it is unbounded, and beside creases from one side only.
    folded = np.zeros(len(fixed), bool)
    folded[problem.creases] = True
    reached = (within_rings(F, held, FINE_RINGS) & (problem.types > 0)) | within_rings(F, folded, NEAR)
    # Goals with K given push the surface, and curvature is singular under a push.
    pushed = bool(problem.goals) and not any(isinstance(goal, Unknown) for goal in problem.goals)
    low = judged & _is_opposite(measured.gaussian, targets, least[at]) & ~reached[at] & (not pushed)
    bad = judged & (visible | _is_confirmed(problem, at, measured.gaussian, targets, least[at], low))
    return Points(at[bad], 2.0 * np.sqrt(excess[bad] / np.pi), measured.gaussian[bad])


def _is_opposite(read: FloatArray, targets: FloatArray, least: FloatArray) -> Mask:
    """Return where readings (p,) have the other sign than targets (p,) and are off by more than half of these, or of the least (p,)."""
    return (read * types_of(targets) < 0.0) & (np.abs(read - targets) > HALF * np.maximum(np.abs(targets), least))


def _is_confirmed(problem: CGCProblem, at: IntArray, read: FloatArray, targets: FloatArray, least: FloatArray, where: Mask) -> Mask:
    """Return where (p,) the median of K as read (p,) and of polynomials of two degrees around vertices (p,) is opposite to targets (p,)."""
    if not where.any():
        return where
    wanted = np.zeros(len(problem.vertices), bool)
    wanted[at[where]] = True
    through = problem.roles == INTERNAL
    V, F = problem.vertices, problem.faces
    fits = [local_fits(V, F, wanted, through, *fit, pinned=False, layout=False) for fit in ((3, 2), (FINE_DEGREE, FINE_RINGS))]
    return where & _is_opposite(np.median([read, *(fit.gaussian[at] for fit in fits)], axis=0), targets, least)


def on_held_edges(problem: CGCProblem) -> Mask:
    """Return the vertices (n,) on edges of the boundary and of creases whose ends are both fixed, or on a level edge."""
    edges = edge_faces(problem.faces)
    candidates = np.vstack([edges[edges[:, 3] < 0, :2], problem.creases])
    held, found = problem.roles == FIXED, np.zeros(len(problem.vertices), bool)
    for place in bind(problem).places if problem.goals else ():
        if isinstance(place, Level):
            held[np.asarray(place.vertices, np.int64)] = True
    found[candidates[held[candidates].all(axis=1)]] = True
    return found


def dip(problem: CGCProblem, measured: MeasuredCurvature) -> tuple[int, float]:
    """Return the lowest vertex below the supports around it, and its depth below their lower hull [L]; -1, 0 without any.

    Where K̄ > 0 everywhere, a surface over a convex plan that bulges to one side stays on that side of the hull of its supports.
    Where it does not, it dips between them, as at the free end of a valley.
    """
    fixed, asked = problem.roles == FIXED, problem.asked
    if not asked.any() or not (problem.types[asked] > 0).all() or fixed.sum() < 3 or fixed[asked].any():
        return -1, 0.0
    V, F = problem.vertices, problem.faces
    areas = face_areas(V, F)
    normal = areas @ face_normals(V, F)
    if np.linalg.norm(normal) < PLAN_SHARE * areas.sum():
        return -1, 0.0
    bulge = float(np.nansum(measured.mean * measured.areas))
    up = np.sign(bulge) * normal / max(float(np.linalg.norm(normal)), TINY)
    along = np.linalg.svd(np.eye(3) - np.outer(up, up))[0][:, :2]
    plan, heights = V @ along, V @ up
    inside, floor = _floor(plan[fixed], heights[fixed], plan)
    below = np.where(inside, floor - heights, 0.0)
    lowest = int(np.argmax(below))
    height = float(heights.max() - heights[fixed].min())
    return (lowest, float(below[lowest])) if below[lowest] > DEEP * height else (-1, 0.0)


def _floor(plan: FloatArray, heights: FloatArray, at: FloatArray) -> tuple[Mask, FloatArray]:
    """Return which places (n, 2) lie within the hull of points in plan (k, 2), and the lower hull of their heights there (n,)."""
    try:
        outline = ConvexHull(plan).equations
        reach = float(np.ptp(plan, axis=0).max())
        apex = np.append(plan.mean(axis=0), heights.max() + APEX * reach)
        hull = ConvexHull(np.vstack([np.column_stack([plan, heights]), apex]))
    except (QhullError, ValueError):
        return np.zeros(len(at), bool), np.zeros(len(at))
    inside = (at @ outline[:, :2].T + outline[:, 2] <= 1e-9 * reach).all(axis=1)
    lower = hull.equations[~(hull.simplices == len(plan)).any(axis=1)]
    a, b, c, d = lower[lower[:, 2] < 0.0].T
    return inside, -((np.outer(at[:, 0], a) + np.outer(at[:, 1], b) + d) / c).max(axis=1, initial=-np.inf)
