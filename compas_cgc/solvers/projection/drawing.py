"""The drawing as it was meant, where supports were pulled out of a sheet that was drawn before them."""

from __future__ import annotations

from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Mask
from ...linalg import factorise
from ...model.problem import CGCProblem
from ...model.roles import CREASE
from ...model.tolerances import ROUNDING
from ..constants import FACING
from ..constants import GROUND
from ..constants import LOCAL_ROUNDING
from .metric import bending_matrix
from .placement import movable_vertices
from .settings import ProjectionSettings

__all__ = ["as_meant"]

# bending of a sheet over that with its supports put back, above which they were pulled out of it; half and twice it select the same
PULLED = 5.0


def as_meant(problem: CGCProblem) -> CGCProblem:
    """Return the problem with its sheet carried along by supports that were pulled out of it.

    Columns given their heights in a flat mesh leave spikes on it. Nobody meant these, nor that the rest hangs below. The
    heights by which supports lie off the sheet are added to all of it, as a plate carries them; what relief it has of its own it keeps.

    Parameters
    ----------
    problem
        Vertices, faces, roles and constraints.
    """
    V, F = problem.vertices, np.ascontiguousarray(problem.faces[problem.real_faces])
    movable = movable_vertices(problem, F)
    used = np.zeros(len(V), bool)
    used[F] = True
    fixed = used & ~movable
    if not fixed.any() or not movable.any():
        return problem
    up = _up(V, F, fixed)
    if up is None:
        return problem
    heights = V @ up
    if np.ptp(heights) <= LOCAL_ROUNDING * np.ptp(V):
        return problem

    def bending_of(vertices: FloatArray) -> sparse.csr_matrix:
        return bending_matrix(vertices, F, problem.roles == CREASE, ProjectionSettings().crease_stiffness)

    sheet = _plate(bending_of(V), V, fixed, heights)
    bending = bending_of(V + (sheet - heights)[:, None] * up)
    own, drawn = (float(part @ (bending @ part)) for part in (sheet, heights))
    if drawn <= PULLED * own + ROUNDING * float(bending.diagonal().sum()) * float(np.ptp(heights)) ** 2:
        return problem
    off = heights - sheet
    carried = _plate(bending, V, ~fixed, np.where(fixed, off, float(off[fixed].mean())))
    return problem.with_vertices(V + (movable * (sheet + carried - heights))[:, None] * up)


def _up(vertices: FloatArray, faces: IntArray, fixed: Mask) -> Optional[FloatArray]:
    """Return the direction (3,) that the sheet between supports faces, None where it faces none."""
    corners = vertices[faces]
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    apart = ~fixed[faces].any(axis=1)
    crosses = crosses[apart] if apart.any() else crosses
    facing = crosses.sum(axis=0)
    length = float(np.linalg.norm(facing))
    return facing / length if length > FACING * float(np.linalg.norm(crosses, axis=1).sum()) else None


def _plate(bending: sparse.csr_matrix, points: FloatArray, free: Mask, heights: FloatArray) -> FloatArray:
    """Return the heights (n,) of a plate, some of which (n,) are let go, at which the others hold them with the least energy."""
    rows = bending[np.flatnonzero(free)]
    own = rows[:, np.flatnonzero(free)]
    firm = (own + GROUND * float(own.diagonal().max()) * sparse.identity(own.shape[0])).tocsr()
    result = heights.copy()
    result[free] -= factorise(firm, symmetric=True, points=points[free], refine=False).solve(rows @ heights)
    return result
