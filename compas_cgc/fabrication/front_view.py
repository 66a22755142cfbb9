"""Views that show the parts of a surface: the plan with elevations of steep parts, or of an upright surface its elevation."""

from __future__ import annotations

import numpy as np

from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..model.problem import CGCProblem

__all__ = ["PLAN", "all_views", "front_view", "is_plan", "seen_from", "view_name", "views_of"]

PLAN = np.eye(3)  # axes of a view from above
UPRIGHT = 0.5  # z of the mean normal below which a surface, or a part of it, is upright
SIDE_TOLERANCE = 1e-9  # difference of unit vectors that count as equal
SIDES = ("south", "east", "north", "west")


def front_view(problem: CGCProblem) -> FloatArray:
    """Return unit vectors to the right, upwards and to the viewer (3, 3): :data:`PLAN`, or of an upright surface from outside."""
    V, F = problem.vertices, problem.faces
    out = (face_areas(V, F)[:, None] * face_normals(V, F)).sum(axis=0)
    if abs(out[2]) >= UPRIGHT * np.linalg.norm(out):
        return PLAN
    return _elevation(np.array([out[0], out[1], 0.0]) / np.hypot(out[0], out[1]))


def all_views(problem: CGCProblem) -> FloatArray:
    """Return the axes of the plan and of elevations from the south, east, north and west, or of the one front view (k, 3, 3)."""
    front = front_view(problem)
    if not is_plan(front):
        return front[None]
    return np.array([front, *(_elevation(side) for side in _sides(problem.drawing.north))])


def _sides(north: tuple[float, float]) -> FloatArray:
    """Return the directions of the south, east, north and west (4, 3)."""
    x, y = np.array(north) / np.hypot(*north)
    return np.array([[-x, -y, 0.0], [y, -x, 0.0], [x, y, 0.0], [-y, x, 0.0]])


def _elevation(towards: FloatArray) -> FloatArray:
    return np.array([np.cross([0.0, 0.0, 1.0], towards), [0.0, 0.0, 1.0], towards])


def views_of(views: FloatArray, normals: FloatArray, owner: IntArray, count: int) -> IntArray:
    """Return the number of the view that shows each part best: for steep parts an elevation, otherwise the plan (p,).

    Parameters
    ----------
    views
        ``(k, 3, 3)`` axes of :func:`all_views`.
    normals
        ``(m, 3)`` area vectors of the faces.
    owner
        ``(m,)`` part of every face.
    count
        Number of parts.
    """
    total = np.stack([np.bincount(owner, normals[:, axis], count) for axis in range(3)], axis=1)
    if len(views) == 1:
        return np.zeros(count, np.int64)
    total *= np.copysign(1.0, normals[:, 2].sum())
    steep = np.abs(total[:, 2]) < UPRIGHT * np.linalg.norm(total, axis=1)
    return np.where(steep, 1 + np.argmax(total @ views[1:, 2].T, axis=1), 0)


def is_plan(axes: FloatArray) -> bool:
    """Check whether axes (3, 3) are those of a plan."""
    return bool(axes[2, 2] == 1.0)


def view_name(axes: FloatArray, north: tuple[float, float]) -> str:
    """Return the name of a view: plan, elevation, or the elevation from a side for a direction of north in plan."""
    if is_plan(axes):
        return "plan"
    seen = np.flatnonzero(np.abs(_sides(north) - axes[2]).max(axis=1) < SIDE_TOLERANCE)
    return f"{SIDES[seen[0]]} elevation" if len(seen) else "elevation"


def seen_from(axes: FloatArray) -> str:
    """Return from where a view is seen."""
    return "seen from above, x to the right and y up" if is_plan(axes) else "seen from outside, z up"
