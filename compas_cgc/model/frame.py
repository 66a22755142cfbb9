"""Local frame: coordinates about the centroid at unit size, which make a solve independent of units and position."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from .motion import Triple

__all__ = ["Frame", "local_frame"]


class Frame(NamedTuple):
    """A local frame: ``local = (model - origin) / scale``."""

    origin: FloatArray  # (3,) model coordinates of the local origin [L]
    scale: float  # model length of one local unit [L], a power of two

    def to_local(self, vertices: FloatArray) -> FloatArray:
        """Return model coordinates ``(n, 3)`` in this frame."""
        return (vertices - self.origin) / self.scale

    def to_model(self, vertices: FloatArray) -> FloatArray:
        """Return local coordinates ``(n, 3)`` in the model."""
        return vertices * self.scale + self.origin

    # As a motion, see :class:`~compas_cgc.model.motion.Motion`.

    @property
    def up(self) -> float:
        """The z axis keeps its direction."""
        return 1.0

    def points(self, points: FloatArray) -> FloatArray:
        """Return model points ``(..., 3)`` in this frame."""
        return self.to_local(points)

    def direction(self, vector: Triple) -> Triple:
        """Return a direction ``(3,)``, which stays."""
        return vector

    def height(self, z: float) -> float:
        """Return a model height in this frame."""
        return (z - float(self.origin[2])) / self.scale

    def plan(self, points: ArrayLike) -> FloatArray:
        """Return model points ``(k, 2)`` or ``(k, 3)`` in plan ``(k, 2)`` in this frame."""
        flat = np.asarray(points, dtype=np.float64)[:, :2]
        return (flat - self.origin[:2]) / self.scale

    def measure(self, value: float, power: int = 1) -> float:
        """Return a model length, area or volume [L^power] in this frame."""
        return value / self.scale**power


def local_frame(vertices: FloatArray, faces: IntArray) -> Frame:
    """Return the frame about the centroid of the vertices of faces (m, 3), with a bounding-box diagonal between 1 and 2.

    The scale is a power of two, so that scaling is free of rounding.
    """
    of_faces = np.zeros(len(vertices), bool)
    of_faces[faces] = True
    used = vertices[of_faces] if len(faces) else vertices
    low, high = used.min(axis=0), used.max(axis=0)
    size = float(np.linalg.norm(high - low))
    scale = 2.0 ** math.floor(math.log2(size)) if size > 0 else 1.0
    return Frame(used.mean(axis=0), scale)
