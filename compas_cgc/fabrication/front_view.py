"""View in which a surface is drawn to show its parts: the plan, or of an upright surface the elevation from outside."""

from __future__ import annotations

import numpy as np

from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..model.problem import CGCProblem

__all__ = ["PLAN", "front_view", "is_plan", "seen_from", "view_name"]

PLAN = np.eye(3)  # axes of a view from above
UPRIGHT = 0.5  # z of the mean normal below which a surface is upright


def front_view(problem: CGCProblem) -> FloatArray:
    """Return unit vectors to the right, upwards and to the viewer (3, 3): :data:`PLAN`, or of an upright surface from outside."""
    V, F = problem.vertices, problem.faces
    out = (face_areas(V, F)[:, None] * face_normals(V, F)).sum(axis=0)
    if abs(out[2]) >= UPRIGHT * np.linalg.norm(out):
        return PLAN
    front = np.array([out[0], out[1], 0.0]) / np.hypot(out[0], out[1])
    return np.array([np.cross([0.0, 0.0, 1.0], front), [0.0, 0.0, 1.0], front])


def is_plan(axes: FloatArray) -> bool:
    """Check whether axes (3, 3) are those of a plan."""
    return bool(axes[2, 2] == 1.0)


def view_name(axes: FloatArray) -> str:
    """Return the name of a view: plan or elevation."""
    return "plan" if is_plan(axes) else "elevation"


def seen_from(axes: FloatArray) -> str:
    """Return from where a view is seen."""
    return "seen from above, x to the right and y up" if is_plan(axes) else "seen from outside, z up"
