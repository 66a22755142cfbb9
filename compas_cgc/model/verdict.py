"""Whether a surface is one that somebody would build: fair or rough, with numbers and reasons."""

from __future__ import annotations

from dataclasses import asdict
from dataclasses import dataclass
from typing import Optional

import numpy as np

from ..discrete import angle_defects
from ..discrete import boundary_vertices
from ..discrete import edge_faces
from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete import vertex_areas
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.corners import corner_angles
from ..discrete.local_fits import LocalFits
from ..discrete.local_fits import local_fits
from ..errors import names_what_was_meant
from ..meshing.regions import vertex_labels
from .branch_points import DEEP
from .branch_points import branch_points
from .branch_points import depth
from .faults import fault
from .goals.inequalities import Bound
from .problem import CGCProblem
from .roles import CREASE
from .roles import DUMMY
from .roles import FIXED

__all__ = ["Verdict", "verdict"]

MEDIAN, MOST = 0.05, 0.3  # errors of the fits, against the targets, of a fair surface: the median, and that of nine in ten
DEGREE, RINGS = 4, 3  # of the polynomials that decide where cubic ones, over two rings, are off
COARSE = 0.6  # what cubic fits on a sphere are off, against (radius of the fit / radius of the sphere)^2
COARSEST = 0.25  # that square above which a fit tells nothing, and no more is allowed for it
FAINT = 0.1  # target, against the largest, below which errors are held against that
WAVY, WAVIEST = 0.2, 0.4  # residual of a fit, against its bending, at three in four and at nineteen in twenty vertices
FLAT = 0.3  # bending, against the median, below which residuals are held against that
LEVEL = 0.01  # bending, against the radius of the fit, likewise: nobody sees waves of a part of that
BOTH = 0.05  # part of a region with K > 0 that may bulge to the other side
SHARP = 1.6  # fold, against the most that a smooth surface through the vertices has, that is too sharp
SLIGHT = np.radians(3.0)  # fold that nobody sees
KINK = np.radians(8.0)  # fold of a single edge, besides the most of a smooth surface and as much again as it may differ, that is seen
TIP = np.radians(9.0)  # turn of a surface of K > 0 across a single support, besides that of its curvature, that is seen
CREASED = 0.02  # part of the edges that may fold too sharply
NEEDLE = 3.0  # smallest angle of a triangle [degree], if it was twice that
LOST = 0.6  # part of the area that has to be left
SHALLOW = {3: 0.0, 2: 0.2, 1: 0.35}  # what fits are off besides, where vertices are no farther from these
ENOUGH = 12  # vertices that tell a median


@dataclass(frozen=True)
class Verdict:
    """How fair a surface is; lists no reasons where it is.

    Parameters
    ----------
    fair
        Whether nothing speaks against it.
    reasons
        One sentence each.
    fit_median
        |K - K̄| / |K̄| of polynomials fitted away from edges, the median; None without any.
    fit_most
        The same, of nine in ten of the vertices.
    waviness
        Distance of vertices from the fits against the bending of these, of nineteen in twenty.
    bulging_both_ways
        Part of the vertices with K > 0 that bulge to the other side than the rest of their region.
    sharpest_fold
        Between two faces, creases apart [degree].
    folds_too_sharp
        Part of the inner edges that fold more than curvature and edge length call for.
    smallest_angle
        Of a triangle [degree].
    area_kept
        Area against that of the input, None without one.
    places
        Vertices where a rough surface is rough, dummies left out.

    Examples
    --------
    >>> import compas_cgc
    >>> found = compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm"))).verdict
    >>> found.fair, found.reasons
    (True, [])
    """

    fair: bool
    reasons: list[str]  # one sentence each
    fit_median: Optional[float]  # |K - K̄| / |K̄| of polynomials fitted away from edges, the median; None without any
    fit_most: Optional[float]  # the same, of nine in ten of the vertices
    waviness: Optional[float]  # distance of vertices from the fits against the bending of these, of nineteen in twenty
    bulging_both_ways: float  # part of the vertices with K > 0 that bulge to the other side than the rest of their region
    sharpest_fold: float  # between two faces, creases apart [degree]
    folds_too_sharp: float  # part of the inner edges that fold more than curvature and edge length call for
    smallest_angle: float  # of a triangle [degree]
    area_kept: Optional[float]  # area against that of the input, None without one
    places: list[int]  # vertices where a rough surface is rough, dummies left out

    @property
    def roughness(self) -> float:
        """The largest of fit, waviness and bulging against what a fair surface has of it, to compare surfaces by."""
        return max((self.fit_most or 0.0) / MOST, (self.waviness or 0.0) / WAVIEST, self.bulging_both_ways / BOTH)

    @property
    def word(self) -> str:
        """``fair`` or ``rough``."""
        return "fair" if self.fair else "rough"

    def __str__(self) -> str:
        return self.word if self.fair else "rough: " + "; ".join(self.reasons)

    def to_dict(self) -> dict:
        """Return plain data, ready for JSON."""
        return {"word": self.word, **asdict(self)}


@names_what_was_meant()
def verdict(problem: CGCProblem, before: Optional[FloatArray] = None) -> Verdict:
    """Judge the vertices of a problem, whatever its angle defects say.

    Polynomials fitted to two rings, or those of a higher degree fitted to three, must have the curvature asked for, as far
    as the mesh is fine enough to tell, and the vertices must lie on them; a region with K > 0 must bulge to one side; edges
    must fold no more than the curvature and their length call for; within a region bending must not change suddenly; and
    triangles must not be drawn out or lost. Beside supports the surface asked for may itself be singular (K > 0 at a straight
    edge): fits are compared where they look all ways.

    Parameters
    ----------
    problem
        Vertices, faces, roles, targets and creases.
    before
        ``(n, 3)`` where its vertices were before [L].

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
    fits = local_fits(V, F, problem.asked, problem.asked, layout=False)
    error, own = _errors(problem, fits)
    wave = _waves(fits)
    other = _bulging_otherwise(problem, fits)
    off_creases = _off_creases(problem)
    edges, fold, called = _folds(problem, fits, off_creases)
    torn = fault(problem, fits, off_creases[:, :2])
    sharp = (fold > SHARP * called) & (fold > SLIGHT)
    kinked = fold - SHARP * called
    angle = _smallest_angle(V, F)
    kept = None if before is None else float(face_areas(V, F).sum() / face_areas(before, F).sum())

    if _is_off(error - own):
        # What cubic polynomials miss on stretched or coarse triangles those of higher degree tell, over more of them.
        finer = local_fits(V, F, problem.asked, problem.asked, DEGREE, RINGS, pinned=False, layout=False).gaussian
        closer = _against(problem, fits, np.where(np.isfinite(error) & np.isfinite(finer), finer, fits.gaussian), np.isfinite(error))
        error = error if _is_off(closer - own) else closer
    median, most = _percentiles(error, 50, 90)
    wavy, waviest = _percentiles(wave, 75, 95)
    positive = np.isfinite(fits.mean) & (problem.targets > 0)
    both = float(other.sum() / positive.sum()) if positive.any() else 0.0
    too_sharp = float(sharp.mean()) if len(sharp) else 0.0
    sharpest = float(np.degrees(fold.max(initial=0.0)))
    reasons = []
    if _is_off(error - own):
        off = f"{_percent(median or 0.0)} % off the curvature asked for, and up to {_percent(most or 0.0)} %"
        reasons.append(f"polynomials fitted to it are {off}")
    if wavy is not None and waviest is not None and (wavy > WAVY or waviest > WAVIEST):
        reasons.append(f"it is wavy: vertices lie up to {_percent(waviest)} % of its bending off a smooth surface")
    if both > BOTH:
        # What a bound bends to the other side no crease mends.
        bound = any(isinstance(own, Bound) for own in problem.constraints)
        between = "with a fold between" + ("" if bound else " (a crease there may mend that)")
        reasons.append(f"{_percent(both)} % of it bulge to the other side than the rest of their region, {between}")
    if too_sharp > CREASED:
        reasons.append(f"{_percent(too_sharp)} % of its edges fold more sharply than its curvature calls for, up to {sharpest:.0f} degrees")
    elif kinked.max(initial=0.0) > KINK:
        worst = int(np.argmax(kinked))
        a, b = problem.names.vertices[edges[worst]].tolist()
        bent, most_bent = np.degrees([fold[worst], called[worst]])
        reasons.append(f"it is kinked: between vertices {a} and {b} it folds by {bent:.0f} degrees, where {most_bent:.0f} are called for")
    if len(torn.vertices):
        at = problem.names.vertices[torn.worst]
        reasons.append(
            f"it has a fault at vertex {at} and {len(torn.vertices) - 1} others: over one edge its bending changes by up to "
            f"{_percent(torn.change)} % (draw a crease along it, hold fewer points of its edge, or ask for a smaller K)"
        )
    if before is not None and angle < NEEDLE and 2 * angle < _smallest_angle(before, F):
        reasons.append(f"triangles are drawn out to needles of {angle:.2g} degrees")
    if kept is not None and kept < LOST:
        reasons.append(f"it has {_percent(kept)} % of the area of the input")
    branches = branch_points(problem, fits)
    if len(branches):
        at = problem.names.vertices[branches[int(np.argmax(fits.gaussian[branches]))]]
        reasons.append(
            f"it has a branch point at vertex {at}, where K is 0 whatever is asked and more valleys meet than its supports need "
            "(draw it as a saddle, or ask for a smaller K)"
        )
    tips, pointed = _tips(problem)
    if (pointed > TIP).any():
        at = problem.names.vertices[tips[int(np.argmax(pointed))]]
        reasons.append(f"it comes to a tip of {np.degrees(pointed.max()):.0f} degrees at its support at vertex {at}")
    bad = (error - own > MOST) | (wave > WAVIEST) | other
    bad[edges[sharp]] = True
    bad[torn.vertices] = True
    bad[branches] = True
    bad[tips[pointed > TIP]] = True
    places = np.flatnonzero(bad).tolist() if reasons else []
    return Verdict(not reasons, reasons, median, most, waviest, both, sharpest, too_sharp, angle, kept, places)


def _percent(share: float) -> str:
    return f"{100 * share:.0f}" if share >= 0.1 else f"{100 * share:.2g}"


def _percentiles(values: FloatArray, low: float, high: float) -> tuple[Optional[float], Optional[float]]:
    known = values[np.isfinite(values)]
    if not known.size:
        return None, None
    first, second = np.percentile(known, [low, high]).tolist()
    return first, second


def _errors(problem: CGCProblem, fits: LocalFits) -> tuple[FloatArray, FloatArray]:
    """Return the relative error of the fits' K where they look all ways (n,), else NaN, and what of it is the fits' own.

    On a surface with the curvatures κ a fit of radius r is off by about ``κ^2 (κ r)^2``.
    """
    fitted = np.isfinite(fits.gaussian)
    away = depth(problem)
    least = next((least for least in range(DEEP, 1, -1) if (fitted & (away >= least)).sum() >= ENOUGH), 1)
    deep = fitted & (away >= least)
    error = _against(problem, fits, fits.gaussian, deep)
    if not fitted.any():
        return error, error
    scale = _scale(problem, fits)
    square = np.where(problem.targets == 0.0, np.median(_principal(fits)[fitted] ** 2), np.abs(problem.targets))
    own = COARSE * square / scale * np.minimum(square * fits.radius**2, COARSEST)
    return error, np.where(deep, own + SHALLOW[least], np.nan)


def _against(problem: CGCProblem, fits: LocalFits, K: FloatArray, where: Mask) -> FloatArray:
    """Return how far K (n,) is off the targets, in parts of these, at some vertices (n,), else NaN."""
    return np.where(where, np.abs(K - problem.targets) / _scale(problem, fits), np.nan)


def _is_off(excess: FloatArray) -> bool:
    """Return whether errors (n,), less what of them is the fits' own, are more than a fair surface has."""
    middle, most = _percentiles(excess, 50, 90)
    return middle is not None and most is not None and (middle > MEDIAN or most > MOST)


def _scale(problem: CGCProblem, fits: LocalFits) -> FloatArray:
    """Return what errors of K are held against (n,)."""
    return np.maximum(np.abs(problem.targets), _least(problem, fits))


def _principal(fits: LocalFits) -> FloatArray:
    """Return the larger principal curvature, without its sign (n,)."""
    return np.abs(fits.mean) + np.sqrt(np.maximum(fits.mean**2 - fits.gaussian, 0.0))


def _least(problem: CGCProblem, fits: LocalFits) -> FloatArray:
    """Return the curvatures (n,) that are small, whatever is asked.

    Where K = 0 is asked of a bent surface, that is one with a principal curvature of FAINT times the other.
    """
    targets = problem.targets[problem.asked]
    least = FAINT * float(np.abs(targets).max(initial=0.0))
    if not targets.any():
        least = 1.0 / max(float(face_areas(problem.vertices, problem.faces).sum()), np.finfo(float).tiny)
    flat = np.isfinite(fits.mean) & (problem.targets == 0.0)
    bent = FAINT * float(np.median(4.0 * fits.mean[flat] ** 2)) if flat.any() else 0.0
    return np.where(problem.targets == 0.0, max(least, bent), least)


def _waves(fits: LocalFits) -> FloatArray:
    """Return the residuals of the fits against their bending (n,), NaN without a fit."""
    bent = np.isfinite(fits.sagitta)
    if not bent.any():
        return np.full(len(bent), np.nan)
    floor = np.maximum(FLAT * float(np.median(fits.sagitta[bent])), LEVEL * fits.radius)
    return fits.residual / np.maximum(fits.sagitta, floor)


def _bulging_otherwise(problem: CGCProblem, fits: LocalFits) -> Mask:
    """Return the vertices with K > 0 that are convex to another side than most of their region (n,)."""
    region = vertex_labels(len(problem.vertices), problem.faces, problem.regions())
    known = np.isfinite(fits.mean) & problem.asked & (problem.targets > 0) & (region >= 0)
    side = np.sign(fits.mean[known])
    most = np.bincount(region[known], weights=side, minlength=region.max(initial=0) + 1)
    other = np.zeros(len(known), bool)
    other[known] = side * most[region[known]] < 0
    return other


def _folds(problem: CGCProblem, fits: LocalFits, edges: IntArray) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return those edges off the creases (e, 4) that a fit is at (k, 2), their angles, and the most that a smooth surface has there [rad].

    A paraboloid sampled at the corners of two triangles of heights a and b over their edge turns across it by its
    curvature times ``(a + b) / 2``, and along it lifts their tops by ``s t / 2``, with s and t the parts of the edge on
    both sides of their feet.
    """
    V, F = problem.vertices, problem.faces
    u, v, left, right = edges.T
    normals, areas = face_normals(V, F), face_areas(V, F)
    here, there = np.take(normals, left, axis=0), np.take(normals, right, axis=0)
    apart, along = here - there, here + there
    fold = 2.0 * np.arctan2(np.sqrt(np.einsum("ij,ij->i", apart, apart)), np.sqrt(np.einsum("ij,ij->i", along, along)))
    principal = _principal(fits)
    known = np.isfinite(principal[u]) | np.isfinite(principal[v])
    along = V[v] - V[u]
    squared = np.maximum(np.einsum("ij,ij->i", along, along), np.finfo(float).tiny)
    turned = np.zeros(len(edges))
    for face in (left, right):
        top = V[F[face].sum(axis=1) - u - v] - V[u]
        foot = np.einsum("ij,ij->i", top, along) / squared
        height = np.maximum(2.0 * areas[face] / np.sqrt(squared), np.finfo(float).tiny)
        turned += height / 2.0 + np.abs(foot * (1.0 - foot)) * squared / (2.0 * height)
    return edges[known, :2], fold[known], (np.fmax(principal[u], principal[v]) * turned)[known]


def _tips(problem: CGCProblem) -> tuple[IntArray, FloatArray]:
    """Return single supports (k,) within K > 0, and by how much the surface turns over each as over the tip of a cone (k,) [rad].

    A cone of the slope s has the angle defect ``π s^2``.
    """
    V, F = problem.vertices, problem.faces
    inner = (problem.roles == FIXED) & ~boundary_vertices(V, F)
    if not inner.any():
        return np.flatnonzero(inner), np.zeros(0)
    smooth = problem.asked & (problem.targets > 0)
    least, total, count = np.ones(len(V), bool), np.zeros(len(V)), np.zeros(len(V))
    beside = F[inner[F].any(axis=1)]
    for turn in (1, -1):
        other = np.roll(beside, turn, axis=1)
        np.logical_and.at(least, beside, smooth[other])
        np.add.at(total, beside, np.where(smooth, problem.targets, 0.0)[other])
        np.add.at(count, beside, 1.0)
    tips = np.flatnonzero(inner & least & (count > 0))
    if not len(tips):
        return tips, np.zeros(0)
    excess = angle_defects(V, F) - total / np.maximum(count, 1.0) * vertex_areas(V, F)
    return tips, 2.0 * np.sqrt(np.abs(excess[tips]) / np.pi)


def _off_creases(problem: CGCProblem) -> IntArray:
    edges = edge_faces(problem.faces)
    edges = edges[edges[:, 3] >= 0]
    if not len(problem.creases) and not (problem.roles == CREASE).any():
        return edges
    n = len(problem.vertices)
    code, creases = np.sort(edges[:, :2], axis=1) @ [n, 1], np.sort(problem.creases, axis=1) @ [n, 1]
    on_crease = (problem.roles[edges[:, 0]] == CREASE) & (problem.roles[edges[:, 1]] == CREASE)
    return edges[~(np.isin(code, creases) | on_crease)]


def _smallest_angle(V: FloatArray, F: IntArray) -> float:
    return float(np.degrees(corner_angles(V, F).min(initial=np.pi)))
