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
from .metric import bending_matrix
from .placement import movable_vertices

__all__ = ["as_meant"]

PULLED = 5.0  # bending of a sheet, against that with its supports where the rest of it has them, from which they were pulled out
FLAT = 1e-12  # bending, likewise, that is none
LEVEL = 1e-14  # difference of heights, against the extent of a drawing, that is none
SOFT = 0.1  # bending stiffness across creases, as a part of that elsewhere
HELD = 1e-9  # what holds a plate that nothing else holds, against its stiffness
TURNS = 4  # renewals of a plate as it turns
FACING = 0.5  # part of the area that faces one way from which a mesh has a plan


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
    movable = movable_vertices(problem, F, problem.constraints)
    used = np.zeros(len(V), bool)
    used[F] = True
    fixed = used & ~movable
    if not fixed.any() or not movable.any():
        return problem
    up = _up(V, F, fixed)
    if up is None:
        return problem
    heights = V @ up
    if np.ptp(heights) <= LEVEL * np.ptp(V):
        return problem
    sheet = _least(_bending(problem, V, F), heights, fixed)
    bending = _bending(problem, V + (sheet - heights)[:, None] * up, F)
    own, drawn = (float(part @ (bending @ part)) for part in (sheet, heights))
    none = FLAT * float(bending.diagonal().sum()) * float(np.ptp(heights)) ** 2
    if drawn <= PULLED * own + none:
        return problem
    shape = V + (movable * (sheet + _carried(bending, heights - sheet, fixed) - heights))[:, None] * up
    for _ in range(TURNS if own <= none else 0):
        # The sheet has turned with its supports, and so has what counts as its height.
        up = _up(shape, F, np.zeros_like(fixed))
        if up is None:
            break
        heights = shape @ up
        shape = shape + (movable * (_carried(_bending(problem, shape, F), heights, fixed) - heights))[:, None] * up
    return problem.with_vertices(np.where(movable[:, None], shape, V))


def _carried(bending: sparse.csr_matrix, heights: FloatArray, fixed: Mask) -> FloatArray:
    """Return the heights (n,) of a plate through those of some vertices (n,)."""
    return _least(bending, np.where(fixed, heights, float(heights[fixed].mean())), ~fixed)


def _up(vertices: FloatArray, faces: IntArray, fixed: Mask) -> Optional[FloatArray]:
    """Return the direction (3,) that the sheet between supports faces, None where it faces none."""
    corners = vertices[faces]
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    apart = ~fixed[faces].any(axis=1)
    crosses = crosses[apart] if apart.any() else crosses
    facing = crosses.sum(axis=0)
    length = float(np.linalg.norm(facing))
    return facing / length if length > FACING * float(np.linalg.norm(crosses, axis=1).sum()) else None


def _bending(problem: CGCProblem, vertices: FloatArray, faces: IntArray) -> sparse.csr_matrix:
    return bending_matrix(vertices, faces, problem.roles == CREASE, SOFT)


def _least(matrix: sparse.csr_matrix, heights: FloatArray, free: Mask) -> FloatArray:
    """Return the heights (n,), some of which (n,) are let go, at which the others hold them with the least energy."""
    result, rows = heights.copy(), matrix[np.flatnonzero(free)]
    own = rows[:, np.flatnonzero(free)]
    held = own + HELD * float(own.diagonal().max()) * sparse.identity(own.shape[0])
    result[free] -= factorise(held.tocsr(), symmetric=True, refine=False).solve(rows @ heights)
    return result
