"""Settings of the projection."""

from __future__ import annotations

from dataclasses import dataclass

from ..settings import EXACT_TEXT
from ..settings import MEASURE_TEXT
from ..settings import MEASURES
from ..settings import REST_TEXT
from ..settings import TOLERANCE_TEXT
from ..settings import Settings
from ..settings import documented
from ..settings import option

__all__ = ["AUTO", "KEEP", "ProjectionSettings"]

# What nearness weighs in plan and in height, by what the designer wants to keep.
KEEP = {"plan": (0.1, 1e-6), "shape": (1.0, 1.0), "nothing": (1e-4, 1e-6)}
AUTO = "auto"


@documented
@dataclass(frozen=True)
class ProjectionSettings(Settings):
    """Parameters of the projection; none of them has a unit, so they fit any model.

    Examples
    --------
    >>> from compas_cgc import ProjectionSettings
    >>> ProjectionSettings(measure="exact").measure
    'exact'
    """

    steps: int = option(300, "Most steps to take.", int, low=1)
    tolerance: float = option(1e-12, TOLERANCE_TEXT + REST_TEXT, float, low=0)
    keep: str = option(
        AUTO,
        "What of the drawing the surface keeps. Its plan, seen along the direction that the mesh faces, while heights go where the "
        "surface bends least; its shape, plan and heights; or nothing but the supports. With auto its shape where it bends far more "
        "than its supports make it, and its plan elsewhere.",
        str,
        choices=(AUTO, *KEEP),
    )
    measure: str = option(
        AUTO,
        MEASURE_TEXT + EXACT_TEXT,
        str,
        choices=MEASURES,
    )
    nearness: float = option(1.0, "Weight of what is kept of the drawing. Only its ratio to the smoothness counts.", float, above=0)
    smoothness: float = option(
        0.1,
        "Length over which bending outweighs nearness, as a part of the square root of the area, where nearness is one. Small: the "
        "surface keeps to the drawing and K is mended on the spot. Large: it bends as a whole, like a plate.",
        float,
        above=0,
    )
    crease_stiffness: float = option(
        0.1,
        "Stiffness of creases, the same on coarse and fine meshes: zero lets them fold freely, one half as easily as a strip bends that "
        "is a seventh of the distance between them wide, one takes no notice of them.",
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
        "When the straight way to the targets is long, let smaller targets grow to them. When it stalls, try other starts, less "
        "smoothness, then more of it, and at last targets that come from the curvature of the start in stages.",
        bool,
    )
