"""NURBS surfaces fitted to regions: cubic tensor-product splines, their distance from the mesh and the K of the splines themselves."""

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

LEAST, MOST = 8, 32  # control points along a side where K is fitted
FINER = (1.0, 1.6, 2.5)  # times as many that a region may have, as far as it takes
LOST = 2.0  # distances allowed, from which on the four sides do not suit a region: an L has more corners
OVER = 1.3  # times as many control points for one that overhangs instead
NEAR, OFF = 1.25, 0.01  # of the distance allowed, and of K: what is good enough
FLAT = 0.02  # least K that errors are measured against, where the size is 1
IN_FACE = (1.0 + 3.0 * np.eye(3)) / 6.0  # places where K is fitted in a face
ON_CURVE = 8  # points of a cut for each edge of the mesh
FREE = 6  # control points along a side at which vertices are met one by one, where it is not
PER_EDGE = 0.5  # further ones for each edge along it
CORNER = np.radians(30.0)  # turn of an edge, from which four of them are the corners of a patch
UPRIGHT = 0.2  # least cosine between the normals of a region and their mean, where it is fitted over a plane
RIM = 0.03  # of the size of a region, by which a patch overhangs
STIFF = 1e-9  # weight of the bending of the spline against that of the points
STEADY = 1e-13  # ... where the points are those of a spline themselves
SAMPLES = 3  # places along a side for each control point, by which a surface gets other knots
CORRECTIONS = 6  # rounds in which the points' parameters follow the surface
ON_EDGE = 4.0  # weight of the vertices on the edge of a region, where others begin
MARGIN = 0.75  # edges of the mesh
WITHIN = 4e-5  # of the size, that vertices may be off for the sake of K


class FittedSurface(NamedTuple):
    """A cubic spline surface, not rational."""

    control: FloatArray  # (a, b, 3) control points [L]
    knots_u: FloatArray  # (a + 4,) with the ends four times
    knots_v: FloatArray  # (b + 4,)
    deviation: float  # largest distance of a vertex of the mesh from it [L]
    gaussian: FloatArray  # (k,) K of the surface itself at middles of faces that do not reach the region's edge [1/L^2]
    edges: tuple[FloatArray, ...] = ()  # (k, 3) closed lines along which it is to be cut, where it overhangs [L]


def fit_region(vertices: FloatArray, faces: IntArray, K: Optional[float] = None, within: Optional[float] = None) -> FittedSurface:
    """Fit a spline surface to a region in the way that suits it, with as many control points as it takes.

    With four sides the surface is laid between them, otherwise it overhangs. Control points are added to the surface found so far
    until it is near the vertices and has K to a hundredth; of what was tried the best is returned.

    Parameters
    ----------
    vertices, faces, K, within
        As for :func:`fit_surface`.

    Raises
    ------
    MeshError
        If the region is closed, or has no four sides and turns away from its mean plane.
    """
    region = _normalised(vertices, faces)
    reach = NEAR * (WITHIN * region.scale if within is None else within)

    def lacks(fit: FittedSurface) -> float:
        error = 0.0 if K is None else float(np.median(np.abs(fit.gaussian - K))) / max(abs(K), FLAT / region.scale**2)
        return max(fit.deviation / reach, 1.0) ** 2 * max(error / OFF, 1.0)

    four = has_four_sides(vertices, faces)
    start: Optional[FittedSurface] = None
    tried: list[FittedSurface] = []
    for finer in FINER:
        start = (fit_surface if four else fit_overhanging)(vertices, faces, K=K, within=within, finer=finer, start=start)
        tried.append(start)
        stuck = len(tried) > 1 and start.deviation > LOST * reach
        if lacks(start) <= 1.0 or stuck or min(start.control.shape[:2]) >= MOST:
            break
    best = min(tried, key=lacks)
    if four and best.deviation > reach:
        # An L has more corners than four, and may lie over a plane better.
        with suppress(MeshError):
            best = min(best, fit_overhanging(vertices, faces, K=K, within=within, finer=OVER), key=lacks)
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

    The boundary is laid out on the sides of a square by its four sharpest corners and the rest by a harmonic map; a smoothing
    spline is fitted, and the parameters of the points are moved to their closest points on it, over and over.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` triangles of the region.
    size
        Control points in both directions. Default: by the vertices along the sides.
    K
        The K asked for, which is fitted too [1/L^2]. Default: only the points are.
    within
        Distance of the vertices that this may cost [L]. Default: 0.00004 of the region's size.
    finer
        Times as many control points along the sides as by default.
    start
        Surface fitted to the region with fewer control points, from which the fit to K sets out. Default: it begins anew.

    Raises
    ------
    MeshError
        If the region is no disc.

    References
    ----------
    Hoschek, doi:10.1016/0167-8396(88)90005-2.
    """
    region = _normalised(vertices, faces)
    if len(region.loops) != 1 or region.euler != 1:
        raise MeshError("a region with holes, or a closed one, has no four sides; cut it by a crease to fit a NURBS surface")
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
    # At its edge a surface may have no K at all: along a straight support none above zero.
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
    """Fit a spline surface over a rectangle in the mean plane of a region, which overhangs its edges: for discs, triangles and holes.

    Parameters
    ----------
    vertices, faces, K, within, finer, start
        As for :func:`fit_surface`.

    Returns
    -------
    FittedSurface
        With the edges along which it is to be cut.

    Raises
    ------
    MeshError
        If the region is closed, or turns away from its mean plane.
    """
    region = _normalised(vertices, faces)
    K = K if K is not None and np.isfinite(K) else None
    P, F = region.points, region.faces
    normals = face_normals(P, F)
    mean = (normals * face_areas(P, F)[:, None]).sum(axis=0)
    mean /= max(float(np.linalg.norm(mean)), 1e-300)
    if not region.loops or (normals @ mean).min() < UPRIGHT:
        raise MeshError("a region that is closed or turns over is no surface over a plane; cut it by a crease to fit a NURBS surface")
    flat = P - np.outer(P @ mean, mean)
    axes = np.linalg.svd(flat - flat.mean(axis=0), full_matrices=False)[2][:2]
    plan = P @ axes.T
    low, high = plan.min(axis=0) - RIM, plan.max(axis=0) + RIM
    uv = (plan - low) / (high - low)
    edge = float(np.linalg.norm(P[F[:, 1]] - P[F[:, 0]], axis=1).mean())
    a, b = (_count(own, K is not None, finer) for own in ((high - low) / edge).tolist())
    knots, free = (knots_for(a), knots_for(b)), np.empty(0, np.int64)
    start = start if K is not None else None
    control, uv = _settled(P, uv, knots, (a, b), free) if start is None else _refined(region, start, uv, knots, (a, b), free)
    inner = _inner_faces(region)
    fit, on = _scaled(region, control, knots, uv, uv[inner].mean(axis=1)), uv
    if K is not None:
        # K is read off at the middles of faces, so it is fitted at other places in them.
        places = np.einsum("pc,fcx->fpx", IN_FACE, uv[inner]).reshape(-1, 2)
        control, uv = _curved(region, uv, control, knots, places, free, K, within, start is not None)
        curved = _better(fit, _scaled(region, control, knots, uv, uv[inner].mean(axis=1)), K)
        fit, on = (fit, on) if curved is fit else (curved, uv)
    return fit._replace(edges=tuple(_cut(fit, on[loop], _turns(P[loop])) for loop in region.loops))


def _cut(fit: FittedSurface, uv: FloatArray, turn: FloatArray) -> FloatArray:
    """Return points (k, 3) on a surface along the smooth curve through parameters (n, 2), which bends sharply where it turns much (n,)."""
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
        places = np.interp(np.arange(ON_CURVE * (end - begin)) / ON_CURVE, np.arange(end - begin + 1), along[own])
        parts.append(curve(places))
    on = np.concatenate([*parts, ring[-1:]])
    return spline_points(fit.control, (fit.knots_u, fit.knots_v), on)


def has_four_sides(vertices: FloatArray, faces: IntArray) -> bool:
    """Tell whether a region is a disc whose edge turns sharply at four places at least."""
    region = _normalised(vertices, faces)
    if len(region.loops) != 1 or region.euler != 1:
        return False
    turn = _turns(region.points[region.loops[0]])
    return bool(np.count_nonzero(turn > CORNER) >= 4)


class _Region(NamedTuple):
    """A region of size 1 around the origin."""

    points: FloatArray  # (n, 3)
    faces: IntArray  # (m, 3)
    loops: list[IntArray]  # vertices around its edges
    euler: int  # number: 1 for a disc
    used: IntArray  # (n,) vertices of the mesh
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
    """Return the faces (k, 3) that do not reach the edge of a region, where a surface may have no K at all; of a few faces all."""
    rim = np.zeros(len(region.points), bool)
    rim[np.concatenate(region.loops)] = True
    inner = region.faces[~rim[region.faces].any(axis=1)]
    return inner if len(region.faces) > 3 * rim.sum() else region.faces


def _better(plain: FittedSurface, curved: FittedSurface, K: float) -> FittedSurface:
    """Return the surface that was fitted to K too, unless it is farther from the mesh and from K than the one that was not."""
    lost = plain.deviation < curved.deviation and np.median(np.abs(plain.gaussian - K)) < np.median(np.abs(curved.gaussian - K))
    return plain if lost else curved


def _settled(P: FloatArray, uv: FloatArray, knots: Knots, shape: tuple[int, int], loop: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return the control points of a smoothing spline, and the parameters (n, 2) of the points on it."""
    control = _fitted(P, uv, knots, shape)
    for _ in range(CORRECTIONS):
        uv = _closest(P, uv, control, knots, loop)
        control = _fitted(P, uv, knots, shape)
    return control, uv


def _refined(
    region: _Region, start: FittedSurface, uv: FloatArray, knots: Knots, shape: tuple[int, int], loop: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return the control points of a surface with other knots that is nearly the same, and the parameters (n, 2) of the points on it."""
    places = _places(SAMPLES * max(shape), (0.0, 0.0))
    on = spline_points((start.control - region.centre) / region.scale, (start.knots_u, start.knots_v), places)
    control = _fitted(on, places, knots, shape, STEADY)
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
    """Return the control points of a surface with the K asked for, and the parameters (n, 2) of the points on it."""
    weights = np.ones(len(uv))
    weights[np.concatenate(region.loops)] = ON_EDGE
    reach = WITHIN if within is None else within / region.scale
    control = curvature_fitted(control, knots, region.points, uv, weights, places, K * region.scale**2, reach, begun)
    return control, _closest(region.points, uv, control, knots, loop)


def _scaled(region: _Region, control: FloatArray, knots: Knots, uv: FloatArray, places: FloatArray) -> FittedSurface:
    """Return a fit in the lengths of the model, its K read off at places (k, 2)."""
    gap = float(np.linalg.norm(spline_points(control, knots, uv) - region.points, axis=1).max())
    K = gaussian(control, knots, places) / region.scale**2
    return FittedSurface(control * region.scale + region.centre, *knots, gap * region.scale, K)


def _count(edges: float, fits_K: bool, finer: float) -> int:
    """Return how many control points a side of so many edges gets; without K more of them would only ripple."""
    count = edges + 1 if fits_K else min(edges + 1, FREE + PER_EDGE * max(0.0, edges + 1 - FREE))
    return int(np.clip(round(finer * count), LEAST if fits_K else DEGREE + 1, MOST))


def _square(P: FloatArray, F: IntArray, loop: IntArray) -> tuple[FloatArray, tuple[float, float]]:
    """Return parameters (n, 2) in the unit square, and the mean numbers of vertices along its two pairs of sides."""
    rim = P[loop]
    turn = _turns(rim)
    corners: list[int] = []
    for k in np.argsort(-turn, kind="stable").tolist():
        if all(min(abs(k - other), len(loop) - abs(k - other)) >= max(2, len(loop) // 12) for other in corners):
            corners.append(k)
        if len(corners) == 4:
            break
    if len(corners) < 4:
        raise MeshError("a region with so few vertices on its boundary cannot be fitted; refine the mesh")
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
    """Return the angles (k,) by which a closed line turns at its points [rad]."""
    ahead, behind = np.roll(rim, -1, axis=0) - rim, rim - np.roll(rim, 1, axis=0)
    return np.arctan2(np.linalg.norm(np.cross(behind, ahead), axis=1), np.einsum("ij,ij->i", behind, ahead))


def _fitted(P: FloatArray, uv: FloatArray, knots: Knots, shape: tuple[int, int], stiff: float = STIFF) -> FloatArray:
    """Return the control points (a, b, 3) of the smoothing spline."""
    B = basis(uv, knots)
    normal = B.T @ B / len(P) + stiff * bending(knots, shape)
    return np.reshape(spsolve(normal.tocsc(), B.T @ P / len(P)), (*shape, 3))


def _closest(P: FloatArray, uv: FloatArray, control: FloatArray, knots: Knots, loop: IntArray) -> FloatArray:
    """Return parameters (n, 2) moved to the closest points; those on the boundary stay on their side."""
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
    """Return parameters (k, 2) spread over the square, none of them in a margin along its sides."""
    t = (np.arange(count) + 0.5) / count
    grid = np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.array(margin) + (1.0 - 2.0 * np.array(margin)) * grid
