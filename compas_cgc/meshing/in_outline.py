"""What of a mesh lies within a closed line in plan."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray

__all__ = ["inside_outline", "vertices_over"]


def inside_outline(points: FloatArray, outline: FloatArray) -> NDArray[np.bool_]:
    """Return which points (k, 2 or 3) lie within a closed line (p, 2 or 3), seen from above, by the parity of crossings."""
    x, y = points[:, 0, None], points[:, 1, None]
    x0, y0 = outline[:, 0], outline[:, 1]
    x1, y1 = np.roll(x0, -1), np.roll(y0, -1)
    spans = (y0 > y) != (y1 > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = x0 + (y - y0) * (x1 - x0) / (y1 - y0)
    return np.count_nonzero(spans & (x < crossing), axis=1) % 2 == 1


def vertices_over(vertices: FloatArray, faces: IntArray, outline: FloatArray) -> tuple[IntArray, IntArray]:
    """Return the vertices that lie over a closed line's inside or on the line, and all corners of the faces that reach over it."""
    low, high = outline[:, :2].min(axis=0), outline[:, :2].max(axis=0)
    rim = 1e-9 * float(np.ptp(outline[:, :2], axis=0).max())
    plan = vertices[:, :2]
    near = np.flatnonzero(((plan >= low - rim) & (plan <= high + rim)).all(axis=1))
    within = near[inside_outline(plan[near], outline) | (_distance(plan[near], outline) <= rim)]
    corners = plan[faces]
    close = faces[((corners.max(axis=1) > low) & (corners.min(axis=1) < high)).all(axis=1)]
    own = np.zeros(len(vertices), bool)
    own[within] = True
    strictly = np.zeros(len(vertices), bool)
    strictly[within[inside_outline(plan[within], outline) & (_distance(plan[within], outline) > rim)]] = True
    reach = [face for face in close if strictly[face].any() or _meet(plan[face], outline[:, :2], rim)]
    return within, np.unique(np.concatenate([within, np.ravel(reach).astype(np.int64)]))


def _meet(triangle: FloatArray, outline: FloatArray, rim: float) -> bool:
    """Return whether the insides of a triangle (3, 2) and of a closed line (p, 2) without a corner of the one in the other meet."""
    if (inside_outline(outline, triangle) & (_distance(outline, triangle) > rim)).any():
        return True
    for p, q in zip(triangle, np.roll(triangle, -1, axis=0)):
        for a, b in zip(outline, np.roll(outline, -1, axis=0)):
            if _turn(p, q, a) * _turn(p, q, b) < 0.0 and _turn(a, b, p) * _turn(a, b, q) < 0.0:
                # A touch within rounding is no crossing.
                if min(map(abs, (_turn(p, q, a), _turn(p, q, b), _turn(a, b, p), _turn(a, b, q)))) > rim * float(np.ptp(outline)):
                    return True
    return False


def _turn(p: FloatArray, q: FloatArray, r: FloatArray) -> float:
    return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))


def _distance(points: FloatArray, outline: FloatArray) -> FloatArray:
    start = outline[:, :2]
    along = np.roll(start, -1, axis=0) - start
    square = np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
    share = np.clip(((points[:, None, :2] - start) * along).sum(axis=2) / square, 0.0, 1.0)
    foot = start + share[:, :, None] * along
    return np.sqrt(((points[:, None, :2] - foot) ** 2).sum(axis=2)).min(axis=1)
