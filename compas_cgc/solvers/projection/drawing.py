"""The drawing as it was meant, where supports were pulled out of a sheet that was drawn before them."""

from __future__ import annotations

from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Mask
from ...linalg import LinearSolver
from ...linalg import factorise
from ...linalg.nearby import nearly_solved
from ...model.problem import CGCProblem
from ...model.roles import CREASE
from ...model.tolerances import NEGLIGIBLE
from ...model.tolerances import ROUNDING
from ..coarse import coarsened
from ..constants import COARSE_VERTICES
from ..constants import FACING
from ..constants import GROUND
from ..constants import HUGE_MESH
from ..constants import LOCAL_ROUNDING
from .metric import bending_matrix
from .placement import movable_vertices

__all__ = ["as_meant"]

# bending of a sheet over that with its supports put back, above which they were pulled out of it; half and twice it select the same
PULLED = 5.0
SOFT = 0.1  # bending stiffness across creases relative to that elsewhere; half and twice it select the same drawings
TURNS = 4  # renewals of the plate as its normal turns; with half and twice as many, heights differ by rounding errors


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
    movable = movable_vertices(problem, F, problem.goals)
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
    sheet = _Plate(_bending(problem, V, F), V, fixed).least(heights)
    bending = _bending(problem, V + (sheet - heights)[:, None] * up, F)
    own, drawn = (float(part @ (bending @ part)) for part in (sheet, heights))
    none = ROUNDING * float(bending.diagonal().sum()) * float(np.ptp(heights)) ** 2
    if drawn <= PULLED * own + none:
        return problem
    if len(V) > HUGE_MESH:
        # A plate is smooth: it is found on a coarser mesh in a small part of the time.
        carried = _carried_on_coarse(problem, V + (sheet - heights)[:, None] * up)
        if carried is not None:
            return problem.with_vertices(np.where(movable[:, None], carried, V))
    shape = V + (movable * (sheet + _Plate(bending, V, ~fixed).carried(heights - sheet) - heights))[:, None] * up
    near = None
    for _ in range(TURNS if own <= none else 0):
        # The sheet has turned with its supports, and so has what counts as its height.
        up = _up(shape, F, np.zeros_like(fixed))
        if up is None:
            break
        heights, plate = shape @ up, _Plate(_bending(problem, shape, F), shape, ~fixed)
        near = near or plate.factors()  # it hardly turns any more after the first time
        shape = shape + (movable * (plate.carried(heights, near) - heights))[:, None] * up
    return problem.with_vertices(np.where(movable[:, None], shape, V))


def _carried_on_coarse(problem: CGCProblem, sheet: FloatArray) -> Optional[FloatArray]:
    """Return the vertices (n, 3) of a sheet (n, 3) carried along by its supports as on a coarser mesh, None where there is none."""
    coarse = coarsened(problem.with_vertices(sheet), COARSE_VERTICES)
    if coarse is None:
        return None
    drawn = coarse.problem.vertices.copy()
    held = np.flatnonzero(~coarse.problem.movable[: len(coarse.kept)])
    drawn[held] = problem.vertices[coarse.kept[held]]
    pulled = coarse.problem.with_vertices(drawn)
    meant = as_meant(pulled)
    return None if meant is pulled else coarse.carried(meant.vertices)


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


class _Plate:
    """The heights of a plate, some of which (n,) are let go, at which the others hold them with the least energy."""

    def __init__(self, bending: sparse.csr_matrix, points: FloatArray, free: Mask):
        self._points = points[free]
        self._free, self._rows = free, bending[np.flatnonzero(free)]
        own = self._rows[:, np.flatnonzero(free)]
        self._own = (own + GROUND * float(own.diagonal().max()) * sparse.identity(own.shape[0])).tocsr()

    def factors(self) -> LinearSolver:
        """Return the factors of its matrix."""
        return factorise(self._own, symmetric=True, points=self._points, refine=False)

    def least(self, heights: FloatArray, near: Optional[LinearSolver] = None) -> FloatArray:
        """Return the heights (n,), by factors of a matrix near to its own where there are some."""
        right, result = self._rows @ heights, heights.copy()
        move = None if near is None else nearly_solved(self._own, near.solve, right, NEGLIGIBLE)
        result[self._free] -= self.factors().solve(right) if move is None else move
        return result

    def carried(self, heights: FloatArray, near: Optional[LinearSolver] = None) -> FloatArray:
        """Return the heights (n,) through those that are not let go."""
        return self.least(np.where(self._free, float(heights[~self._free].mean()), heights), near)
