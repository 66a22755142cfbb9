"""How far the faces of a shape may turn in one step."""

from __future__ import annotations

import numpy as np

from ...discrete import face_normals
from ...discrete.arrays import FloatArray
from .system import System

__all__ = ["Turning"]

TURN = 0.5  # cosine of the largest turn of a face in a step; 60°, a face that turns farther may turn over


class Turning:
    """The faces of a shape (n, 3), to be held against those of other shapes.

    Linear equations mean nothing for a move that turns a face over.
    """

    def __init__(self, system: System, vertices: FloatArray):
        self._system = system
        self._normals = face_normals(vertices, system.faces)
        self._folds = np.minimum(system.folds(self._normals), 0.0)

    def allows(self, vertices: FloatArray) -> bool:
        """Return whether no sound face of a shape (n, 3) has turned far, and no edge folds more sharply than a right angle."""
        turned = face_normals(vertices, self._system.faces)
        upright = np.einsum("ij,ij->i", self._normals, turned) >= TURN
        return bool(upright[self._system.sound].all() and (self._system.folds(turned) >= self._folds).all())
