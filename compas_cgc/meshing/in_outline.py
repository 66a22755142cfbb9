"""Vertices and faces of a mesh within a closed polyline in plan."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray

__all__ = ["inside_outline", "vertices_over"]


def inside_outline(points: FloatArray, outline: FloatArray) -> NDArray[np.bool_]:
    """Return which points (k, 2 or 3) lie within a closed polyline (p, 2 or 3) in plan, by ray crossings."""
    x, y = points[:, 0, None], points[:, 1, None]
    x0, y0 = outline[:, 0], outline[:, 1]
    x1, y1 = np.roll(x0, -1), np.roll(y0, -1)
    spans = (y0 > y) != (y1 > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = x0 + (y - y0) * (x1 - x0) / (y1 - y0)
    return np.count_nonzero(spans & (x < crossing), axis=1) % 2 == 1


def vertices_over(vertices: FloatArray, faces: IntArray, outline: FloatArray) -> tuple[IntArray, IntArray]:
    """Return the vertices over a closed polyline or its inside, and all corners of the faces that reach over it."""
    low, high = outline[:, :2].min(axis=0), outline[:, :2].max(axis=0)
    rim = 1e-9 * float(np.ptp(outline[:, :2], axis=0).max())
    plan = vertices[:, :2]
    near = np.flatnonzero(((plan >= low - rim) & (plan <= high + rim)).all(axis=1))
    within = near[inside_outline(plan[near], outline) | (_distance(plan[near], outline) <= rim)]
    strictly = np.zeros(len(vertices), bool)
    strictly[within[inside_outline(plan[within], outline) & (_distance(plan[within], outline) > rim)]] = True
    corners = plan[faces]
    near_by = ((corners.max(axis=1) > low) & (corners.min(axis=1) < high)).all(axis=1)
    close = faces[near_by & ~strictly[faces].any(axis=1)]
    reach = close[_meeting(plan[close], outline[:, :2], rim * float(np.ptp(outline[:, :2])))]
    return within, np.unique(np.concatenate([within, faces[strictly[faces].any(axis=1)].ravel(), reach.ravel()]))


def _meeting(triangles: FloatArray, outline: FloatArray, rounding: float) -> NDArray[np.bool_]:
    """Return which triangles (m, 3, 2) contain a corner of a closed polyline (p, 2) or cross it (m,).

    Touching up to rounding does not count.
    """
    p, q = triangles[:, :, None], np.roll(triangles, -1, axis=1)[:, :, None]
    a, b = outline[None, None], np.roll(outline, -1, axis=0)[None, None]
    of_a, of_b = _turn(p, q, a), _turn(p, q, b)  # (m, 3, p) side of the triangle's side on which a corner of the polyline lies
    of_p, of_q = _turn(a, b, p), _turn(a, b, q)
    crosses = (of_a * of_b < 0.0) & (of_p * of_q < 0.0)
    crosses &= np.minimum(np.minimum(abs(of_a), abs(of_b)), np.minimum(abs(of_p), abs(of_q))) > rounding
    inside: NDArray[np.bool_] = np.logical_or((of_a > rounding).all(axis=1), (of_a < -rounding).all(axis=1))
    return np.logical_or(crosses.any(axis=(1, 2)), inside.any(axis=1))


def _turn(p: FloatArray, q: FloatArray, r: FloatArray) -> FloatArray:
    """Return twice the areas of the triangles p, q, r in plan, positive if they turn left."""
    return (q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1]) - (q[..., 1] - p[..., 1]) * (r[..., 0] - p[..., 0])


def _distance(points: FloatArray, outline: FloatArray) -> FloatArray:
    start = outline[:, :2]
    along = np.roll(start, -1, axis=0) - start
    square = np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
    share = np.clip(((points[:, None, :2] - start) * along).sum(axis=2) / square, 0.0, 1.0)
    foot = start + share[:, :, None] * along
    return np.sqrt(((points[:, None, :2] - foot) ** 2).sum(axis=2)).min(axis=1)
