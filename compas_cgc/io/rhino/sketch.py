"""What is drawn in a model, as arrays: the same from a .3dm file and from inside Rhino."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple
from typing import Optional

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray

__all__ = ["Drawn", "Part"]


class Part(NamedTuple):
    """A mesh of the model."""

    label: str  # how sentences name it
    vertices: FloatArray  # (n, 3) [L]
    faces: IntArray  # (m, 4), a triangle repeats its last corner
    rounding: float  # error that single precision has left in the coordinates [L], 0 in double precision
    target: Optional[float]  # K in its user text or that of its layer [1/L^2]
    text: Mapping[str, str]  # user text, keys in small letters


class Drawn(NamedTuple):
    """A point, point cloud, curve or text dot of the model."""

    label: str  # how sentences name it
    kind: str  # point, point cloud, curve or text dot
    points: FloatArray  # (k, 3) places, or points along the curve [L]
    target: Optional[float]  # K in its text or user text [1/L^2]
    text: Mapping[str, str]  # user text, keys in small letters
