"""Drawn objects as arrays, from a .3dm file or from inside Rhino."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple
from typing import Optional

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...model.laws import Law

__all__ = ["Drawn", "Part"]


class Part(NamedTuple):
    """A mesh of the model."""

    label: str  # name in messages
    vertices: FloatArray  # (n, 3) [L]
    faces: IntArray  # (m, 4), a triangle repeats its last corner
    rounding: float  # rounding error of single-precision coordinates [L], 0 in double precision
    law: Optional[Law]  # in its user text or that of its layer
    text: Mapping[str, str]  # user text, keys in lower case


class Drawn(NamedTuple):
    """A point, point cloud, curve or text dot of the model."""

    label: str  # name in messages
    kind: str  # point, point cloud, curve or text dot
    points: FloatArray  # (k, 3) coordinates, or points along the curve [L]
    law: Optional[Law]  # in its text or user text
    text: Mapping[str, str]  # user text, keys in lower case
