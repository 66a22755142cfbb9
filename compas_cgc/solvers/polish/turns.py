"""Turns that supports leave free: as bending does not see them, the drawing decides them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...discrete import vertex_areas
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Mask
from ...model.tolerances import DRAWING_ACCURACY

__all__ = ["Turns", "free_turns", "no_turns"]


class Turns(NamedTuple):
    """Moves that turn a drawing about its supports, and how moves are turned."""

    moves: FloatArray  # (n, k) by unit turns
    conditions: FloatArray  # (n, k): their products with moves are zero where these are not turned

    def taken_out(self, moves: FloatArray) -> FloatArray:
        """Return moves (n,) without their turns."""
        if not self.moves.shape[1]:
            return moves
        return np.asarray(moves - self.moves @ np.linalg.solve(self.conditions.T @ self.moves, self.conditions.T @ moves))


def no_turns(count: int) -> Turns:
    """Return those of a drawing of `count` vertices whose supports, or whose shape, leave none."""
    return Turns(*np.zeros((2, count, 0)))


def free_turns(drawing: FloatArray, faces: IntArray, up: FloatArray, free: Mask) -> Turns:
    r"""Return the turns about supports on a line, or about a single one, of a plan.

    The moves :math:`u` of a surface are not turned against its drawing if they have no slope in the mean,

    .. math:: \int u \, (\varphi - \bar\varphi) \, dA = 0,

    for every linear function φ of the plan that is zero at the supports.

    Parameters
    ----------
    drawing
        ``(n, 3)`` [L].
    faces
        ``(m, 3)`` vertex indices.
    up
        ``(3,)`` unit vector along which vertices move.
    free
        ``(n,)`` vertices that move.
    """
    x = np.cross(up, np.eye(3)[np.argmin(np.abs(up))])
    x /= np.linalg.norm(x)
    linear = np.column_stack([np.ones(len(drawing)), drawing @ x, drawing @ np.cross(up, x)])
    # Zeros, as there may be fewer supports than functions.
    _, sizes, functions = np.linalg.svd(np.vstack([linear[~free], np.zeros((3, 3))]), full_matrices=False)
    turns = linear @ functions[int((sizes > DRAWING_ACCURACY * sizes[0]).sum()) :].T
    areas = vertex_areas(drawing, faces, "barycentric")
    conditions = areas[:, None] * (turns - areas @ turns / areas.sum())
    return Turns(free[:, None] * turns, free[:, None] * conditions)
