"""Rigid registration of unbent panels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import Vertices

__all__ = ["Fit", "rigid_fits"]


class Fit(NamedTuple):
    """The rigid motion of least squared distance between two sets of points."""

    turn: FloatArray  # (3, 3) rotation
    move: FloatArray  # (3,) [L]
    most: float  # largest remaining distance [L]

    def __call__(self, points: Vertices) -> Vertices:
        """Return points (n, 3) after the motion."""
        return points @ self.turn.T + self.move


def rigid_fits(several: FloatArray, there: Vertices) -> Fit:
    """Return the best rigid motion of one of several point sets (k, n, 3) onto points (n, 3) (Kabsch algorithm)."""
    centres, centre = several.mean(axis=1), there.mean(axis=0)
    here, away = several - centres[:, None], there - centre
    u, _, vt = np.linalg.svd(np.einsum("kni,nj->kij", here, away))
    sign = np.ones((len(several), 3))
    sign[:, 2] = np.linalg.det(u) * np.linalg.det(vt)
    turns = np.einsum("kji,kj,klj->kil", vt, sign, u)
    left = np.einsum("kij,knj->kni", turns, here) - away
    square = np.einsum("kni,kni->k", left, left)
    best = int(np.argmin(square))
    most = float(np.sqrt(np.einsum("ni,ni->n", left[best], left[best]).max(initial=0.0)))
    return Fit(turns[best], centre - turns[best] @ centres[best], most)
