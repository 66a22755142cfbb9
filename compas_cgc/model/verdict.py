"""Verdict on a surface: fair or rough, with numbers and reasons."""

from __future__ import annotations

from dataclasses import asdict
from dataclasses import dataclass
from typing import Optional

import numpy as np

from ..discrete import edge_faces
from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete import vertex_areas
from ..discrete.arrays import TINY
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.corners import corner_angles
from ..discrete.local_fits import LocalFits
from ..discrete.local_fits import local_fits
from ..discrete.measured_curvature import measured_curvature as measured_curvature_of
from ..errors import names_what_was_meant
from ..meshing.regions import vertex_labels
from .branch_points import DEEP
from .branch_points import branch_points
from .branch_points import depth
from .convex_plans import beyond_convex_plans
from .faults import fault
from .goals.inequalities import Bound
from .law_errors import law_errors
from .measures import read_across
from .problem import CGCProblem
from .roles import CREASE
from .roles import DUMMY
from .roles import FIXED
from .roles import INTERNAL
from .visible import FINE_DEGREE
from .visible import FINE_RINGS
from .visible import PLAN_SHARE
from .visible import VISIBLE
from .visible import dip
from .visible import on_held_edges
from .visible import points

__all__ = ["Verdict", "verdict"]

MAX_MEDIAN_ERROR = 0.05  # median relative error of the fitted K on a fair surface; fair surfaces of docs/fairness.md have 0.4 to 2.6 %
MAX_ERROR_90 = 0.3  # 90th percentile of the same; fits beside rims and slivers err more than in the middle
# relative error of cubic fits on a sphere over (radius of the fit / radius of the sphere)²; exact to the leading term on spheres
FIT_ERROR_FACTOR = 0.6
MAX_FIT_SQUARE = 0.25  # largest value of that square; fits over a larger part of the sphere get no further allowance
# smallest reference for relative errors, relative to the largest target; regions of a tenth of it look flat beside the others
TARGET_FLOOR = 0.1
INVISIBLE_SAG = 1e-3  # sagitta of an arc across a surface relative to its size, below which its curvature is invisible; 15 mm on 15 m
FLAT_SHEET = 1e-3  # curvature relative to the largest target, below which a sheet is flat and has no side; its sagitta is as much smaller
MAX_WAVINESS_75 = 0.2  # 75th percentile of the residual of fits over their sagitta on a fair surface; a fifth of the rise is seen as a wave
MAX_WAVINESS_95 = 0.4  # 95th percentile of the same; twice as much at single places
SAGITTA_FLOOR = 0.3  # smallest reference for these residuals relative to the median sagitta; flat spots have no sagitta of their own
RADIUS_FLOOR = 0.01  # smallest reference for these residuals relative to the radius of the fit; smaller waves are invisible
MAX_OTHER_SIDE = 0.05  # largest share of the area with K > 0 that may bulge to the other side; single vertices of coarse meshes may
# fold over the largest fold of a smooth surface through the vertices, above which it is too sharp; irregular triangles fold unevenly
FOLD_RATIO = 1.6
INVISIBLE_FOLD = np.radians(3.0)  # fold that is too small to be seen [rad]; reflections hardly show folds that small
# excess of a single fold over FOLD_RATIO times that of a smooth surface, that is visible [rad]; one displaced vertex causes more
VISIBLE_KINK = np.radians(8.0)
MAX_SHARP_SHARE = 0.02  # largest share of edges that may fold too sharply; edges at single irregular vertices may
# angle of a needle [degrees]; normals of triangles with smaller angles are inaccurate, drawings keep theirs if they are not halved
NEEDLE_ANGLE = 3.0
MIN_AREA_KEPT = 0.6  # smallest share of the area of the input in plan that remains; surfaces that lose more have left their plan
# further relative error of fits by distance from supports in edges; fits nearer to supports are one-sided
FIT_ERROR_NEAR_SUPPORTS = {3: 0.0, 2: 0.2, 1: 0.35}
MIN_SAMPLES = 12  # smallest number of vertices for percentiles; the 90th percentile of fewer is the maximum


@dataclass(frozen=True)
class Verdict:
    """Fairness of a surface; `reasons` is empty if it is fair.

    Parameters
    ----------
    fair
        Whether there are no reasons against it.
    reasons
        One sentence each.
    fit_median
        Median by area of |K - K̄| / |K̄| for polynomials fitted away from the boundary; None without fits.
    fit_most
        90th percentile of the same.
    waviness
        95th percentile by area of the distance of vertices from the fits over the sagitta of these.
    bulging_both_ways
        Part of the area with K > 0 that bulges to the side opposite to most of its region.
    sharpest_fold
        Largest angle between two faces, without creases [degree].
    folds_too_sharp
        Share of the inner edges that fold more than curvature and edge length explain.
    smallest_angle
        Smallest angle of a triangle [degree].
    area_kept
        Area relative to the area of the plan of the input, which is the smallest possible area over the same rim; relative to the
        area of the input if it has no plan; None without an input.
    places
        Indices of the vertices where a rough surface is rough, without dummies.

    Examples
    --------
    >>> import compas_cgc
    >>> found = compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))).verdict
    >>> found.fair, found.reasons
    (True, [])
    """

    fair: bool
    reasons: list[str]  # one sentence each
    fit_median: Optional[float]  # median by area of |K - K̄| / |K̄| of fitted polynomials, None without fits
    fit_most: Optional[float]  # 90th percentile of the same
    waviness: Optional[float]  # 95th percentile by area of residual over sagitta of the fits
    bulging_both_ways: float  # share of the area with K > 0
    sharpest_fold: float  # largest angle between two faces, without creases [degree]
    folds_too_sharp: float  # share of the inner edges
    smallest_angle: float  # smallest angle of a triangle [degree]
    area_kept: Optional[float]  # area over that of the input in plan, None without an input
    places: list[int]  # indices of vertices where the surface is rough

    @property
    def roughness(self) -> float:
        """Largest of fit error, waviness and bulging, each relative to its limit for a fair surface."""
        return max((self.fit_most or 0.0) / MAX_ERROR_90, (self.waviness or 0.0) / MAX_WAVINESS_95, self.bulging_both_ways / MAX_OTHER_SIDE)

    @property
    def word(self) -> str:
        """``fair`` or ``rough``."""
        return "fair" if self.fair else "rough"

    def __str__(self) -> str:
        return self.word if self.fair else "rough: " + "; ".join(self.reasons)

    def to_dict(self) -> dict:
        """Return a dict that can be written as JSON."""
        return {"word": self.word, **asdict(self)}


@names_what_was_meant()
def verdict(problem: CGCProblem, before: Optional[FloatArray] = None) -> Verdict:
    """Judge the fairness of a surface independently of its angle defects.

    On a fair surface, polynomials fitted to two rings of neighbours (or of higher degree to three) have the target curvature
    within the accuracy of the mesh, and the vertices lie on them. A region with K > 0 bulges to one side. Edges fold no more than
    curvature and edge length explain, and bending does not jump within a region. No vertex, supports included, is a
    visible tip or has K of the wrong sign on most readings, and no dome dips between its supports. Triangles are not
    stretched to needles, and
    the area does not collapse. Fits near supports are not compared, because the exact surface may be singular there (K > 0 at
    a straight edge).

    Parameters
    ----------
    problem
        Vertices, faces, roles, targets and creases.
    before
        ``(n, 3)`` vertices before the solve [L].

    Returns
    -------
    Verdict
        Fair or rough, with numbers, reasons and places.

    Examples
    --------
    >>> import compas_cgc
    >>> flat = compas_cgc.read(compas_cgc.get("cushion.3dm")).to_problem()
    >>> verdict(flat).fair, verdict(compas_cgc.solve(flat).problem).fair
    (False, True)
    """
    if before is not None:
        problem, before = problem.without_dummies(), before[problem.roles != DUMMY]
    else:
        problem = problem.without_dummies()
    V, F = problem.vertices, problem.faces
    internal, areas = problem.roles == INTERNAL, vertex_areas(V, F, "barycentric")
    fits = local_fits(V, F, internal, internal, layout=False)
    error, own = _errors(problem, fits)
    wave = _waves(fits)
    other = _bulging_otherwise(problem, fits)
    inner, creased = _inner_edges(problem)
    off_creases = inner[~creased]
    edges, fold, called = _folds(problem, fits, off_creases)
    torn = fault(problem, fits, off_creases[:, :2])
    sharp = (fold > FOLD_RATIO * called) & (fold > INVISIBLE_FOLD)
    kinked = fold - FOLD_RATIO * called
    angle = _smallest_angle(V, F)
    kept = None if before is None else _area_kept(V, before, F)

    if _is_off(error - own, areas):
        # On stretched or coarse triangles cubic fits are inaccurate; fits of higher degree over more rings decide.
        finer = local_fits(V, F, internal, internal, FINE_DEGREE, FINE_RINGS, pinned=False, layout=False).gaussian
        closer = _against(problem, fits, np.where(np.isfinite(error) & np.isfinite(finer), finer, fits.gaussian), np.isfinite(error))
        error = error if _is_off(closer - own, areas) else closer
    median, most = _percentiles(error, areas, 50, 90)
    wavy, waviest = _percentiles(wave, areas, 75, 95)
    positive = np.isfinite(fits.mean) & (problem.types > 0)
    both = float((areas @ other) / (areas @ positive)) if positive.any() else 0.0
    too_sharp = float(sharp.mean()) if len(sharp) else 0.0
    sharpest = float(np.degrees(fold.max(initial=0.0)))
    reasons = beyond_convex_plans(problem, before)
    if _is_off(error - own, areas):
        off = f"{_percent(median or 0.0)} % (median) and {_percent(most or 0.0)} % (90th percentile)"
        reasons.append(f"the curvature of fitted polynomials deviates from its target by {off}")
    for found in law_errors(problem):
        middle, high = _percentiles(found.relative, areas[found.vertices], 50, 90)
        if middle is not None and high is not None and (middle > MAX_MEDIAN_ERROR or high > MAX_ERROR_90):
            off = f"{_percent(middle)} % (median) and {_percent(high)} % (90th percentile)"
            reasons.append(f"region {found.region} deviates from its law {found.law} by {off} of its curvature")
    if wavy is not None and waviest is not None and (wavy > MAX_WAVINESS_75 or waviest > MAX_WAVINESS_95):
        reasons.append(f"it is wavy: vertices deviate from a smooth surface by up to {_percent(waviest)} % of its sagitta")
    if both > MAX_OTHER_SIDE:
        # Where an inequality goal bends the surface to the other side, a crease does not help.
        bound = any(isinstance(own, Bound) for own in problem.goals)
        between = "with a fold between" + ("" if bound else " (draw a crease there)")
        reasons.append(f"{_percent(both)} % of it bulges to the other side than the rest of its region, {between}")
    if too_sharp > MAX_SHARP_SHARE:
        reasons.append(
            f"{_percent(too_sharp)} % of its edges fold more sharply than its curvature explains, by up to {sharpest:.0f} degrees"
        )
    elif kinked.max(initial=0.0) > VISIBLE_KINK:
        worst = int(np.argmax(kinked))
        a, b = problem.names.vertices[edges[worst]].tolist()
        bent, most_bent = np.degrees([fold[worst], called[worst]])
        reasons.append(
            f"it is kinked: between vertices {a} and {b} it folds by {bent:.0f} degrees, but its curvature explains only {most_bent:.0f}"
        )
    if len(torn.vertices):
        at = problem.names.vertices[torn.worst]
        reasons.append(
            f"it has a fault at vertex {at} and {len(torn.vertices) - 1} others: its bending changes by up to {_percent(torn.change)} % "
            "over one edge (draw a crease along the fault, support fewer boundary vertices, or set a smaller K)"
        )
    if before is not None and angle < NEEDLE_ANGLE and 2 * angle < _smallest_angle(before, F):
        reasons.append(f"triangles are stretched to needles with angles down to {angle:.2g} degrees")
    if kept is not None and kept < MIN_AREA_KEPT:
        reasons.append(f"it has only {_percent(kept)} % of the area of the input in plan")
    branches = branch_points(problem, fits)
    if len(branches):
        at = problem.names.vertices[branches[int(np.argmax(fits.gaussian[branches]))]]
        reasons.append(
            f"it has a branch point at vertex {at}, where K is 0 whatever the target and more valleys meet than its supports require "
            "(draw the surface as a saddle, or set a smaller K)"
        )
    measured = measured_curvature_of(V, read_across(problem), inner[creased, :2], problem.regions())
    pointed = points(problem, measured, _least(problem, fits))
    if len(pointed.vertices):
        worst = int(np.argmax(pointed.turns))
        at, turn = pointed.vertices[worst], pointed.turns[worst]
        support = "the support at " if problem.roles[at] == FIXED else ""
        change = "supports or creases" if len(problem.creases) else "supports"
        what = f"it has a sharp tip of {np.degrees(turn):.0f} degrees" if turn > VISIBLE else "its K has the wrong sign"
        reasons.append(
            f"{what} at {support}vertex {problem.names.vertices[at]}, where K is "
            f"{pointed.found[worst]:.3g} (set a smaller |K|, or change the {change} there)"
        )
    lowest, deep = dip(problem, measured)
    if lowest >= 0:
        at = problem.names.vertices[lowest]
        reasons.append(f"it dips by {deep:.3g} below the supports around vertex {at} (support it there, or end creases at supports)")
    bad = (error - own > MAX_ERROR_90) | (wave > MAX_WAVINESS_95) | other
    bad[edges[sharp]] = True
    bad[torn.vertices] = True
    bad[branches] = True
    bad[pointed.vertices] = True
    bad[[lowest] if lowest >= 0 else []] = True
    places = np.flatnonzero(bad).tolist() if reasons else []
    return Verdict(not reasons, reasons, median, most, waviest, both, sharpest, too_sharp, angle, kept, places)


def _percent(share: float) -> str:
    return f"{100 * share:.0f}" if share >= 0.1 else f"{100 * share:.2g}"


def _percentiles(values: FloatArray, areas: FloatArray, low: float, high: float) -> tuple[Optional[float], Optional[float]]:
    """Return two percentiles of values (k,) by area, so that small triangles at a rim do not count for more than they cover."""
    known = np.flatnonzero(np.isfinite(values))
    if not known.size:
        return None, None
    order = known[np.argsort(values[known], kind="stable")]
    middles = np.cumsum(areas[order]) - 0.5 * areas[order]
    first, second = np.interp([low, high], 100.0 * (middles - middles[0]) / max(middles[-1] - middles[0], TINY), values[order]).tolist()
    return first, second


def _errors(problem: CGCProblem, fits: LocalFits) -> tuple[FloatArray, FloatArray]:
    """Return the relative error of the fitted K away from supports (n,), else NaN, and the error expected of the fits themselves (n,).

    On a surface with principal curvatures κ the K of a fit of radius r has an error of about ``κ^2 (κ r)^2``.
    """
    fitted = np.isfinite(fits.gaussian)
    away = depth(problem)
    least = next((least for least in range(DEEP, 1, -1) if (fitted & (away >= least)).sum() >= MIN_SAMPLES), 1)
    deep = fitted & (away >= least)
    error = _against(problem, fits, fits.gaussian, deep)
    if not fitted.any():
        return error, error
    scale = _scale(problem, fits)
    square = np.where(problem.targets == 0.0, np.median(_principal(fits)[fitted] ** 2), np.abs(problem.targets))
    own = FIT_ERROR_FACTOR * square / scale * np.minimum(square * fits.radius**2, MAX_FIT_SQUARE)
    return error, np.where(deep, own + FIT_ERROR_NEAR_SUPPORTS[least], np.nan)


def _against(problem: CGCProblem, fits: LocalFits, K: FloatArray, where: Mask) -> FloatArray:
    """Return the relative error of K (n,) at the vertices `where` (n,), else NaN."""
    return np.where(where, np.abs(K - problem.targets) / _scale(problem, fits), np.nan)


def _is_off(excess: FloatArray, areas: FloatArray) -> bool:
    """Check whether errors (n,) in excess of the fits' own are too large for a fair surface."""
    middle, most = _percentiles(excess, areas, 50, 90)
    return middle is not None and most is not None and (middle > MAX_MEDIAN_ERROR or most > MAX_ERROR_90)


def _scale(problem: CGCProblem, fits: LocalFits) -> FloatArray:
    """Return the reference curvature for relative errors (n,) [1/L^2]."""
    return np.maximum(np.abs(problem.targets), _least(problem, fits))


def _principal(fits: LocalFits) -> FloatArray:
    """Return the larger absolute principal curvature (n,) [1/L]."""
    return np.abs(fits.mean) + np.sqrt(np.maximum(fits.mean**2 - fits.gaussian, 0.0))


def _least(problem: CGCProblem, fits: LocalFits) -> FloatArray:
    """Return the smallest reference curvature for relative errors (n,) [1/L^2].

    In a bent region it is the K of a surface whose second principal curvature is TARGET_FLOOR times the first, so that nearly cylindrical
    regions are judged like cylinders. On a nearly flat surface it is the product of 1/size and the curvature of
    an arc whose sagitta is INVISIBLE_SAG times the size.
    """
    targets = problem.targets[problem.asked]
    size_square = max(float(face_areas(problem.vertices, problem.faces).sum()), TINY)
    least = max(TARGET_FLOOR * float(np.abs(targets).max(initial=0.0)), (8.0 * INVISIBLE_SAG if targets.any() else 1.0) / size_square)
    region = vertex_labels(len(problem.vertices), problem.faces, problem.regions())
    bent = np.zeros(len(region))
    fitted = np.isfinite(fits.mean)
    for own in np.unique(region[fitted]).tolist():
        bent[region == own] = TARGET_FLOOR * float(np.median(4.0 * fits.mean[fitted & (region == own)] ** 2))
    return np.maximum(least, bent)


def _waves(fits: LocalFits) -> FloatArray:
    """Return the residuals of the fits relative to their sagitta (n,), NaN without a fit."""
    bent = np.isfinite(fits.sagitta)
    if not bent.any():
        return np.full(len(bent), np.nan)
    floor = np.maximum(SAGITTA_FLOOR * float(np.median(fits.sagitta[bent])), RADIUS_FLOOR * fits.radius)
    return fits.residual / np.maximum(fits.sagitta, floor)


def _bulging_otherwise(problem: CGCProblem, fits: LocalFits) -> Mask:
    """Return the vertices with K > 0 that bulge to the other side than most of their region (n,)."""
    region = vertex_labels(len(problem.vertices), problem.faces, problem.regions())
    least = FLAT_SHEET * float(np.abs(problem.targets[problem.asked]).max(initial=0.0))
    known = np.isfinite(fits.mean) & problem.asked & (problem.targets > least) & (region >= 0)
    side = np.sign(fits.mean[known])
    most = np.bincount(region[known], weights=side, minlength=region.max(initial=0) + 1)
    other = np.zeros(len(known), bool)
    other[known] = side * most[region[known]] < 0
    return other


def _folds(problem: CGCProblem, fits: LocalFits, edges: IntArray) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return the edges with a fit (k, 2), their fold angles, and the largest fold of a smooth surface there (k,) [rad].

    Edges that end on straight held ones are left out where K̄ > 0: there curvature is not bounded, and no fold too large.

    Two triangles of heights a and b over their common edge, with corners on a paraboloid, fold by the curvature across the edge
    times ``(a + b) / 2``. The curvature along the edge lifts each apex by ``s t / 2``, where s and t are the parts of the edge
    on both sides of the foot of the height.
    """
    V, F = problem.vertices, problem.faces
    u, v, left, right = edges.T
    normals, areas = face_normals(V, F), face_areas(V, F)
    here, there = np.take(normals, left, axis=0), np.take(normals, right, axis=0)
    apart, along = here - there, here + there
    fold = 2.0 * np.arctan2(np.sqrt(np.einsum("ij,ij->i", apart, apart)), np.sqrt(np.einsum("ij,ij->i", along, along)))
    principal = _principal(fits)
    held, positive = on_held_edges(problem), problem.types > 0
    known = (np.isfinite(principal[u]) | np.isfinite(principal[v])) & ~((held[u] | held[v]) & (positive[u] | positive[v]))
    along = V[v] - V[u]
    squared = np.maximum(np.einsum("ij,ij->i", along, along), TINY)
    turned = np.zeros(len(edges))
    for face in (left, right):
        top = V[F[face].sum(axis=1) - u - v] - V[u]
        foot = np.einsum("ij,ij->i", top, along) / squared
        height = np.maximum(2.0 * areas[face] / np.sqrt(squared), TINY)
        turned += height / 2.0 + np.abs(foot * (1.0 - foot)) * squared / (2.0 * height)
    return edges[known, :2], fold[known], (np.fmax(principal[u], principal[v]) * turned)[known]


def _inner_edges(problem: CGCProblem) -> tuple[IntArray, Mask]:
    """Return the inner edges (k, 4) with their faces, and which of them may fold (k,)."""
    edges = edge_faces(problem.faces)
    edges = edges[edges[:, 3] >= 0]
    n = len(problem.vertices)
    code, creases = np.sort(edges[:, :2], axis=1) @ [n, 1], np.sort(problem.creases, axis=1) @ [n, 1]
    return edges, np.isin(code, creases) | (problem.roles[edges[:, :2]] == CREASE).all(axis=1)


def _area_kept(V: FloatArray, before: FloatArray, F: IntArray) -> float:
    """Return the area over that of the input in plan."""
    areas = face_areas(before, F)
    plan = float(np.linalg.norm(areas @ face_normals(before, F)))
    return float(face_areas(V, F).sum()) / (plan if plan > PLAN_SHARE * areas.sum() else float(areas.sum()))


def _smallest_angle(V: FloatArray, F: IntArray) -> float:
    return float(np.degrees(corner_angles(V, F).min(initial=np.pi)))
