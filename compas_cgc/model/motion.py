"""Motions of a surface: what a constraint needs from a local frame or a similarity to follow it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple
from typing import Protocol
from typing import Union

import numpy as np
from numpy.typing import ArrayLike

from ..discrete.arrays import FloatArray
from .tolerances import NEGLIGIBLE
from .tolerances import UPRIGHT_COSINE

__all__ = ["Motion", "Similarity", "Triple", "similarity_of"]

Triple = Union[Sequence[float], FloatArray]  # three numbers


class Motion(Protocol):
    """A map of space that scales all lengths by the same factor."""

    @property
    def up(self) -> float:
        """1 if the z axis keeps its direction, -1 if it is reversed, 0 if it is tilted."""
        ...

    def points(self, points: FloatArray) -> FloatArray:
        """Return the images of points ``(..., 3)`` [L]."""
        ...

    def direction(self, vector: Triple) -> Triple:
        """Return the image of a direction ``(3,)``."""
        ...

    def height(self, z: float) -> float:
        """Return the image of a height [L]; the z axis must not be tilted."""
        ...

    def plan(self, points: ArrayLike) -> FloatArray:
        """Return the images in plan ``(k, 2)`` of points ``(k, 2)`` or ``(k, 3)`` [L]; the z axis must not be tilted."""
        ...

    def measure(self, value: float, power: int = 1) -> float:
        """Return the image of a length, an area or a volume [L^power]."""
        ...


class Similarity(NamedTuple):
    """A similarity: ``image = scale * rotation @ point + translation``."""

    scale: float  # positive
    rotation: FloatArray  # (3, 3) orthogonal; the determinant is -1 for a reflection
    translation: FloatArray  # (3,) [L]

    @property
    def reflects(self) -> bool:
        """Whether the similarity reverses orientation."""
        return float(np.linalg.det(self.rotation)) < 0.0

    @property
    def up(self) -> float:
        """1 if the z axis keeps its direction, -1 if it is reversed, 0 if it is tilted."""
        cosine = float(self.rotation[2, 2])
        return float(np.sign(cosine)) if abs(cosine) >= 1.0 - UPRIGHT_COSINE else 0.0

    def points(self, points: FloatArray) -> FloatArray:
        """Return the images of points ``(..., 3)`` [L]."""
        return self.scale * (points @ self.rotation.T) + self.translation

    def direction(self, vector: Triple) -> FloatArray:
        """Return the image of a direction ``(3,)``."""
        return self.rotation @ np.asarray(vector, dtype=np.float64)

    def height(self, z: float) -> float:
        """Return the image of a height [L]."""
        return self.scale * self.up * z + float(self.translation[2])

    def plan(self, points: ArrayLike) -> FloatArray:
        """Return the images in plan ``(k, 2)`` of points ``(k, 2)`` or ``(k, 3)`` [L]."""
        flat = np.asarray(points, dtype=np.float64)[:, :2]
        return self.scale * (flat @ self.rotation[:2, :2].T) + self.translation[:2]

    def measure(self, value: float, power: int = 1) -> float:
        """Return the image of a length, an area or a volume [L^power]."""
        return value * self.scale**power


def similarity_of(transformation: object) -> Similarity:
    """Return the similarity of a COMPAS transformation or a ``(4, 4)`` matrix.

    Raises
    ------
    ValueError
        If the transformation scales directions differently, shears, projects or is singular.
    """
    matrix = np.asarray(getattr(transformation, "matrix", transformation), dtype=np.float64)
    if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
        raise ValueError(
            f"a transformation must be a COMPAS transformation or a matrix of 4 x 4 finite numbers, not {transformation!r:.60}"
        )
    linear = matrix[:3, :3]
    scale = float(np.sqrt((linear**2).sum() / 3.0))
    rotation = linear / (scale or 1.0)
    uniform = scale > 0.0 and float(np.abs(rotation @ rotation.T - np.eye(3)).max()) <= NEGLIGIBLE
    if not uniform or not np.array_equal(matrix[3], (0.0, 0.0, 0.0, 1.0)):
        raise ValueError(
            "a target curvature follows translation, rotation, reflection and uniform scaling only; scale x, y and z by the same factor, "
            "or transform a plain mesh and set its targets and goals afterwards"
        )
    return Similarity(scale, rotation, matrix[:3, 3].copy())
