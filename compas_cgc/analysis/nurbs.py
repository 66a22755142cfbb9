"""NURBS surfaces fitted to regions: cubic tensor-product splines with their distance from the mesh and their own K."""

from __future__ import annotations

from contextlib import suppress
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.sparse.linalg import spsolve

from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.harmonic import spread_values
from ..errors import MeshError
from ..meshing import boundary_loops
from ._curvature_fit import curvature_fitted
from ._splines import DEGREE
from ._splines import Knots
from ._splines import basis
from ._splines import bending
from ._splines import gaussian
from ._splines import knots_for
from ._splines import spline_points

__all__ = ["FittedSurface", "fit_overhanging", "fit_region", "fit_surface", "has_four_sides"]

MIN_CONTROL, MAX_CONTROL = 8, 32  # control points along a side if K is fitted
REFINEMENTS = (1.0, 1.6, 2.5)  # factors on the number of control points, tried in this order
MAX_MISFIT = 2.0  # distance over the allowed one above which refinement stops: a region such as an L has no four sides
OVERHANG_REFINEMENT = 1.3  # factor on the number of control points of an overhanging patch tried instead
GOOD_DISTANCE, GOOD_ERROR = 1.25, 0.01  # distance over the allowed one, and relative error of K, that end the refinement
CURVATURE_FLOOR = 0.02  # smallest reference for errors of K, for a region of size 1
FACE_WEIGHTS = (1.0 + 3.0 * np.eye(3)) / 6.0  # barycentric coordinates of the points of a face at which K is fitted
POINTS_PER_EDGE = 8  # points of a trimming curve per mesh edge
BASE_CONTROL = 6  # control points along a side if K is not fitted ...
CONTROL_PER_EDGE = 0.5  # ... and further ones per mesh edge
CORNER = np.radians(30.0)  # least turn of the boundary at the corner of a patch
MIN_COSINE = 0.2  # least cosine between the face normals and their mean for a fit over a plane
OVERHANG = 0.03  # overhang of a patch relative to the size of the region
SMOOTHING = 1e-9  # weight of the bending energy relative to that of the points
RESAMPLING_SMOOTHING = 1e-13  # the same if the points are samples of a spline
SAMPLES_PER_CONTROL = 3  # samples along a side per control point when the knots change
CORRECTIONS = 6  # rounds of parameter correction
BOUNDARY_WEIGHT = 4.0  # weight of the vertices on the boundary of a region, which neighbouring patches share
MARGIN = 0.75  # margin along the boundary without K, in mesh edges
DEFAULT_DISTANCE = 4e-5  # default allowed distance of vertices when K is fitted, relative to the size


class FittedSurface(NamedTuple):
    """A non-rational cubic spline surface fitted to a region."""

    control: FloatArray  # (a, b, 3) control points [L]
    knots_u: FloatArray  # (a + 4,) knots with fourfold ends
    knots_v: FloatArray  # (b + 4,)
    deviation: float  # largest distance of a mesh vertex from the surface [L]
    gaussian: FloatArray  # (k,) K of the spline at the centres of inner faces [1/L^2]
    edges: tuple[FloatArray, ...] = ()  # (k, 3) closed trimming curves of an overhanging patch [L]


def fit_region(vertices: FloatArray, faces: IntArray, K: Optional[float] = None, within: Optional[float] = None) -> FittedSurface:
    """Fit a spline surface to a region, with as many control points as needed.

    A region with four sides gets a patch between these, any other an overhanging patch with trimming curves. Control points are
    added until the surface is near the vertices and its K is accurate to 1 %; the best surface is returned.

    Parameters
    ----------
    vertices, faces, K, within
        As for :func:`fit_surface`.

    Raises
    ------
    MeshError
        If the region is closed, or has no four sides and cannot be projected to its mean plane.
    """
    region = _normalised(vertices, faces)
    reach = GOOD_DISTANCE * (DEFAULT_DISTANCE * region.scale if within is None else within)

    def lacks(fit: FittedSurface) -> float:
        error = 0.0 if K is None else float(np.median(np.abs(fit.gaussian - K))) / max(abs(K), CURVATURE_FLOOR / region.scale**2)
        return max(fit.deviation / reach, 1.0) ** 2 * max(error / GOOD_ERROR, 1.0)

    four = has_four_sides(vertices, faces)
    start: Optional[FittedSurface] = None
    tried: list[FittedSurface] = []
    for finer in REFINEMENTS:
        start = (fit_surface if four else fit_overhanging)(vertices, faces, K=K, within=within, finer=finer, start=start)
        tried.append(start)
        stuck = len(tried) > 1 and start.deviation > MAX_MISFIT * reach
        if lacks(start) <= 1.0 or stuck or min(start.control.shape[:2]) >= MAX_CONTROL:
            break
    best = min(tried, key=lacks)
    if four and best.deviation > reach:
        # A region with more corners, such as an L, may fit better over a plane.
        with suppress(MeshError):
            best = min(best, fit_overhanging(vertices, faces, K=K, within=within, finer=OVERHANG_REFINEMENT), key=lacks)
    return best


def fit_surface(
    vertices: FloatArray,
    faces: IntArray,
    size: Optional[tuple[int, int]] = None,
    K: Optional[float] = None,
    within: Optional[float] = None,
    finer: float = 1.0,
    start: Optional[FittedSurface] = None,
) -> FittedSurface:
    """Fit a spline surface to a region of a mesh that has one boundary loop.

    The four sharpest corners map the boundary to the sides of a unit square, and a harmonic map parametrises the interior. A
    smoothing spline is fitted and the parameters are moved to the closest points, in alternation (parameter correction).

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` triangles of the region.
    size
        Numbers of control points in both directions. Default: from the numbers of vertices along the sides.
    K
        Prescribed K, which is fitted too [1/L^2]. Default: only the points are fitted.
    within
        Allowed distance of the vertices when K is fitted [L]. Default: 4e-5 of the size of the region.
    finer
        Factor on the default number of control points.
    start
        Initial surface for the fit to K, with fewer control points. Default: the surface fitted to the points.

    Raises
    ------
    MeshError
        If the region is not a topological disc.

    References
    ----------
    Hoschek, doi:10.1016/0167-8396(88)90005-2.
    """
    region = _normalised(vertices, faces)
    if len(region.loops) != 1 or region.euler != 1:
        raise MeshError(
            "a region with holes, or a closed one, cannot be fitted between four sides; divide it by a crease to fit NURBS surfaces"
        )
    K = K if K is not None and np.isfinite(K) else None
    P, F, loop = region.points, region.faces, region.loops[0]
    uv, sides = _square(P, F, loop)
    a, b = size or tuple(_count(own, K is not None, finer) for own in sides)
    knots = knots_for(a), knots_for(b)
    start = start if K is not None else None
    control, uv = _settled(P, uv, knots, (a, b), loop) if start is None else _refined(region, start, uv, knots, (a, b), loop)
    inner = _inner_faces(region)
    fit = _scaled(region, control, knots, uv, uv[inner].mean(axis=1))
    if K is None:
        return fit
    # K is not fitted at the boundary, where the exact surface may be singular (K > 0 along a straight support).
    margin = (MARGIN / sides[0], MARGIN / sides[1])
    control, uv = _curved(region, uv, control, knots, _places(2 * max(a, b), margin), loop, K, within, start is not None)
    return _better(fit, _scaled(region, control, knots, uv, uv[inner].mean(axis=1)), K)


def fit_overhanging(
    vertices: FloatArray,
    faces: IntArray,
    K: Optional[float] = None,
    within: Optional[float] = None,
    finer: float = 1.0,
    start: Optional[FittedSurface] = None,
) -> FittedSurface:
    """Fit an overhanging spline surface over a rectangle in the mean plane of a region, for regions without four sides.

    Parameters
    ----------
    vertices, faces, K, within, finer, start
        As for :func:`fit_surface`.

    Returns
    -------
    FittedSurface
        With the trimming curves in `edges`.

    Raises
    ------
    MeshError
        If the region is closed, or cannot be projected to its mean plane.
    """
    region = _normalised(vertices, faces)
    K = K if K is not None and np.isfinite(K) else None
    P, F = region.points, region.faces
    normals = face_normals(P, F)
    mean = (normals * face_areas(P, F)[:, None]).sum(axis=0)
    mean /= max(float(np.linalg.norm(mean)), 1e-300)
    if not region.loops or (normals @ mean).min() < MIN_COSINE:
        raise MeshError("a region that is closed or folds over cannot be fitted over a plane; divide it by a crease to fit NURBS surfaces")
    flat = P - np.outer(P @ mean, mean)
    axes = np.linalg.svd(flat - flat.mean(axis=0), full_matrices=False)[2][:2]
    plan = P @ axes.T
    low, high = plan.min(axis=0) - OVERHANG, plan.max(axis=0) + OVERHANG
    uv = (plan - low) / (high - low)
    edge = float(np.linalg.norm(P[F[:, 1]] - P[F[:, 0]], axis=1).mean())
    a, b = (_count(own, K is not None, finer) for own in ((high - low) / edge).tolist())
    knots, free = (knots_for(a), knots_for(b)), np.empty(0, np.int64)
    start = start if K is not None else None
    control, uv = _settled(P, uv, knots, (a, b), free) if start is None else _refined(region, start, uv, knots, (a, b), free)
    inner = _inner_faces(region)
    fit, on = _scaled(region, control, knots, uv, uv[inner].mean(axis=1)), uv
    if K is not None:
        # K is evaluated at face centres, so it is fitted at other points.
        places = np.einsum("pc,fcx->fpx", FACE_WEIGHTS, uv[inner]).reshape(-1, 2)
        control, uv = _curved(region, uv, control, knots, places, free, K, within, start is not None)
        curved = _better(fit, _scaled(region, control, knots, uv, uv[inner].mean(axis=1)), K)
        fit, on = (fit, on) if curved is fit else (curved, uv)
    return fit._replace(edges=tuple(_cut(fit, on[loop], _turns(P[loop])) for loop in region.loops))


def _cut(fit: FittedSurface, uv: FloatArray, turn: FloatArray) -> FloatArray:
    """Return points (k, 3) on the smooth curve through parameters (n, 2), with corners where `turn` (n,) exceeds CORNER."""
    corners = np.flatnonzero(turn > CORNER)
    first = int(corners[0]) if len(corners) else 0
    ring = np.roll(uv, -first, axis=0)
    ring = np.concatenate([ring, ring[:1]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(ring, axis=0), axis=1))])
    stops = [*(corners - first).tolist(), len(uv)] if len(corners) else [0, len(uv)]
    parts = []
    for begin, end in zip(stops[:-1], stops[1:]):
        own = slice(begin, end + 1)
        curve = CubicSpline(along[own], ring[own], bc_type="natural" if len(corners) else "periodic")
        places = np.interp(np.arange(POINTS_PER_EDGE * (end - begin)) / POINTS_PER_EDGE, np.arange(end - begin + 1), along[own])
        parts.append(curve(places))
    on = np.concatenate([*parts, ring[-1:]])
    return spline_points(fit.control, (fit.knots_u, fit.knots_v), on)


def has_four_sides(vertices: FloatArray, faces: IntArray) -> bool:
    """Check whether a region is a disc whose boundary has at least four corners."""
    region = _normalised(vertices, faces)
    if len(region.loops) != 1 or region.euler != 1:
        return False
    turn = _turns(region.points[region.loops[0]])
    return bool(np.count_nonzero(turn > CORNER) >= 4)


class _Region(NamedTuple):
    """A region scaled to size 1 about the origin."""

    points: FloatArray  # (n, 3)
    faces: IntArray  # (m, 3)
    loops: list[IntArray]  # vertices of the boundary loops
    euler: int  # Euler characteristic: 1 for a disc
    used: IntArray  # (n,) indices of the vertices in the mesh
    centre: FloatArray  # (3,) [L]
    scale: float  # [L]


def _normalised(vertices: FloatArray, faces: IntArray) -> _Region:
    used, local = np.unique(faces, return_inverse=True)
    V, F = vertices[used], local.reshape(faces.shape)
    edges = np.unique(np.sort(np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1), axis=0)
    centre, scale = V.mean(axis=0), float(np.linalg.norm(np.ptp(V, axis=0)))
    loops = [np.asarray(loop) for loop in boundary_loops(F)]
    return _Region((V - centre) / scale, F, loops, len(V) - len(edges) + len(F), used, centre, scale)


def _inner_faces(region: _Region) -> IntArray:
    """Return the faces (k, 3) without boundary vertices, where K may be singular; all faces of a small region."""
    rim = np.zeros(len(region.points), bool)
    rim[np.concatenate(region.loops)] = True
    inner = region.faces[~rim[region.faces].any(axis=1)]
    return inner if len(region.faces) > 3 * rim.sum() else region.faces


def _better(plain: FittedSurface, curved: FittedSurface, K: float) -> FittedSurface:
    """Return the surface fitted to K, unless both its distance and its error of K are larger."""
    lost = plain.deviation < curved.deviation and np.median(np.abs(plain.gaussian - K)) < np.median(np.abs(curved.gaussian - K))
    return plain if lost else curved


def _settled(P: FloatArray, uv: FloatArray, knots: Knots, shape: tuple[int, int], loop: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return the control points (a, b, 3) of a smoothing spline, and the parameters (n, 2) of the points."""
    control = _fitted(P, uv, knots, shape)
    for _ in range(CORRECTIONS):
        uv = _closest(P, uv, control, knots, loop)
        control = _fitted(P, uv, knots, shape)
    return control, uv


def _refined(
    region: _Region, start: FittedSurface, uv: FloatArray, knots: Knots, shape: tuple[int, int], loop: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return a surface resampled on other knots: its control points (a, b, 3), and the parameters (n, 2) of the points."""
    places = _places(SAMPLES_PER_CONTROL * max(shape), (0.0, 0.0))
    on = spline_points((start.control - region.centre) / region.scale, (start.knots_u, start.knots_v), places)
    control = _fitted(on, places, knots, shape, RESAMPLING_SMOOTHING)
    for _ in range(CORRECTIONS):
        uv = _closest(region.points, uv, control, knots, loop)
    return control, uv


def _curved(
    region: _Region,
    uv: FloatArray,
    control: FloatArray,
    knots: Knots,
    places: FloatArray,
    loop: IntArray,
    K: float,
    within: Optional[float],
    begun: bool,
) -> tuple[FloatArray, FloatArray]:
    """Return the control points (a, b, 3) of a surface fitted to K, and the parameters (n, 2) of the points."""
    weights = np.ones(len(uv))
    weights[np.concatenate(region.loops)] = BOUNDARY_WEIGHT
    reach = DEFAULT_DISTANCE if within is None else within / region.scale
    control = curvature_fitted(control, knots, region.points, uv, weights, places, K * region.scale**2, reach, begun)
    return control, _closest(region.points, uv, control, knots, loop)


def _scaled(region: _Region, control: FloatArray, knots: Knots, uv: FloatArray, places: FloatArray) -> FittedSurface:
    """Return a fit in model units, with its K at parameters (k, 2)."""
    gap = float(np.linalg.norm(spline_points(control, knots, uv) - region.points, axis=1).max())
    K = gaussian(control, knots, places) / region.scale**2
    return FittedSurface(control * region.scale + region.centre, *knots, gap * region.scale, K)


def _count(edges: float, fits_K: bool, finer: float) -> int:
    """Return the number of control points for a side of `edges` mesh edges; without K, more of them would only cause ripples."""
    count = edges + 1 if fits_K else min(edges + 1, BASE_CONTROL + CONTROL_PER_EDGE * max(0.0, edges + 1 - BASE_CONTROL))
    return int(np.clip(round(finer * count), MIN_CONTROL if fits_K else DEGREE + 1, MAX_CONTROL))


def _square(P: FloatArray, F: IntArray, loop: IntArray) -> tuple[FloatArray, tuple[float, float]]:
    """Return parameters (n, 2) in the unit square, and the mean numbers of vertices along its pairs of sides."""
    rim = P[loop]
    turn = _turns(rim)
    corners: list[int] = []
    for k in np.argsort(-turn, kind="stable").tolist():
        if all(min(abs(k - other), len(loop) - abs(k - other)) >= max(2, len(loop) // 12) for other in corners):
            corners.append(k)
        if len(corners) == 4:
            break
    if len(corners) < 4:
        raise MeshError("a region with fewer than four corners of its boundary cannot be fitted; refine the mesh")
    order = np.roll(np.arange(len(loop)), -min(corners))
    starts = sorted((k - min(corners)) % len(loop) for k in corners)
    length = np.linalg.norm(np.roll(rim[order], -1, axis=0) - rim[order], axis=1)
    at = np.concatenate([[0.0], np.cumsum(length)])
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]], dtype=np.float64)
    ends = [*starts, len(loop)]
    fixed = np.empty((len(loop), 2))
    for k in range(4):
        own = np.arange(ends[k], ends[k + 1])
        t = (at[own] - at[ends[k]]) / (at[ends[k + 1]] - at[ends[k]])
        fixed[own] = square[k] + t[:, None] * (square[k + 1] - square[k])
    uv, known = np.zeros((len(P), 2)), np.zeros(len(P), bool)
    uv[loop[order]], known[loop] = fixed, True
    counts = np.diff(ends)
    return spread_values(P, F, uv, known), (0.5 * (counts[0] + counts[2]), 0.5 * (counts[1] + counts[3]))


def _turns(rim: FloatArray) -> FloatArray:
    """Return the turning angles of a closed polyline at its points (k,) [rad]."""
    ahead, behind = np.roll(rim, -1, axis=0) - rim, rim - np.roll(rim, 1, axis=0)
    return np.arctan2(np.linalg.norm(np.cross(behind, ahead), axis=1), np.einsum("ij,ij->i", behind, ahead))


def _fitted(P: FloatArray, uv: FloatArray, knots: Knots, shape: tuple[int, int], stiff: float = SMOOTHING) -> FloatArray:
    """Return the control points (a, b, 3) of the smoothing spline."""
    B = basis(uv, knots)
    normal = B.T @ B / len(P) + stiff * bending(knots, shape)
    return np.reshape(spsolve(normal.tocsc(), B.T @ P / len(P)), (*shape, 3))


def _closest(P: FloatArray, uv: FloatArray, control: FloatArray, knots: Knots, loop: IntArray) -> FloatArray:
    """Return parameters (n, 2) of the closest points after one Newton step; boundary points stay on their side."""
    off = P - spline_points(control, knots, uv)
    a, b = spline_points(control, knots, uv, (1, 0)), spline_points(control, knots, uv, (0, 1))
    aa, ab, bb = ((x * y).sum(axis=1) for x, y in ((a, a), (a, b), (b, b)))
    p, q = (a * off).sum(axis=1), (b * off).sum(axis=1)
    det = np.maximum(aa * bb - ab * ab, 1e-300)
    move = np.column_stack([bb * p - ab * q, aa * q - ab * p]) / det[:, None]
    held = np.zeros((len(P), 2), bool)
    held[loop] = (uv[loop] <= 0.0) | (uv[loop] >= 1.0)
    inner = np.clip(uv + np.where(held, 0.0, np.clip(move, -0.05, 0.05)), 1e-9, 1.0 - 1e-9)
    return np.where(held, uv, inner)


def _places(count: int, margin: tuple[float, float]) -> FloatArray:
    """Return a grid of parameters (k, 2) in the unit square without a margin."""
    t = (np.arange(count) + 0.5) / count
    grid = np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.array(margin) + (1.0 - 2.0 * np.array(margin)) * grid
