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

# Weights of the nearness in plan and in height.
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

    steps: int = option(300, "Maximum number of steps.", int, low=1)
    tolerance: float = option(1e-12, TOLERANCE_TEXT + REST_TEXT, float, low=0)
    keep: str = option(
        AUTO,
        "Part of the drawing that the surface keeps. plan: the plan as seen along the mean normal; heights follow from least bending. "
        "shape: plan and heights. nothing: supports only. auto: the shape if it bends far more than its supports require, otherwise "
        "the plan.",
        str,
        choices=(AUTO, *KEEP),
    )
    measure: str = option(
        AUTO,
        MEASURE_TEXT + EXACT_TEXT,
        str,
        choices=MEASURES,
    )
    nearness: float = option(1.0, "Weight of the distance to the drawing. Only its ratio to the smoothness matters.", float, above=0)
    smoothness: float = option(
        0.1,
        "Weight of the bending energy: the length, relative to the square root of the area, below which bending counts more than the "
        "distance to the drawing if nearness is 1. Small: the surface stays near the drawing and K is corrected "
        "locally. Large: the surface "
        "bends as a whole, like a plate.",
        float,
        above=0,
    )
    crease_stiffness: float = option(
        0.1,
        "Bending stiffness across creases, independent of the mesh: 0 for free folds, 1 for a surface without creases. At 0.5, a "
        "crease is as stiff as a strip of the surface whose width is a seventh of the distance between creases.",
        float,
        low=0,
        high=1,
    )
    retry: bool = option(
        True,
        "If the solve stalls, retry with other initial guesses, less and more smoothness, and finally targets in stages from the "
        "curvature of the initial surface.",
        bool,
    )
