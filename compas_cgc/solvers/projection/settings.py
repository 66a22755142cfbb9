"""Settings of the projection."""

from __future__ import annotations

from dataclasses import dataclass

from ..settings import TOLERANCE_TEXT
from ..settings import Settings
from ..settings import documented
from ..settings import option

__all__ = ["ProjectionSettings"]


@documented
@dataclass(frozen=True)
class ProjectionSettings(Settings):
    """Parameters of the projection; none of them has a unit, so they fit any model."""

    steps: int = option(100, "Most steps to take.", int, low=1)
    tolerance: float = option(1e-12, TOLERANCE_TEXT, float, low=0)
    nearness: float = option(1.0, "Weight of staying near the input. Only its ratio to the smoothness counts.", float, above=0)
    smoothness: float = option(
        0.1,
        "Length over which the move is kept smooth, as a part of the square root of the area, where nearness is one. Small: the "
        "surface keeps to the input and K is mended on the spot. Large: it bends as a whole, like a plate.",
        float,
        above=0,
    )
    crease_stiffness: float = option(
        0.1,
        "Bending stiffness across creases, as a part of that elsewhere. Zero lets them fold freely, one takes no notice of them.",
        float,
        low=0,
        high=1,
    )
    seed_height: float = option(
        0.15,
        "Height of the start over a flat input, at most. Where the input is flat no small move changes K; there a low dome or "
        "saddle is put on it first, no higher than this part of the mesh's diameter on an open boundary, where flat and steep "
        "surfaces have the same K. Zero: no such start.",
        float,
        low=0,
    )
    retry: bool = option(
        True,
        "When the straight way to the targets stalls, try less smoothness, then more of it, and at last targets that come from the "
        "curvature of the start in stages.",
        bool,
    )
