"""Settings of the method by mid-edge normals."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

from ..settings import TOLERANCE_TEXT
from ..settings import Settings
from ..settings import documented
from ..settings import option

__all__ = ["PolishSettings"]


@documented
@dataclass(frozen=True)
class PolishSettings(Settings):
    """Parameters of the method by mid-edge normals; none has a unit.

    Examples
    --------
    >>> from compas_cgc.solvers.polish.settings import PolishSettings
    >>> PolishSettings(fold_length=0.5).fold_length
    0.5
    """

    steps: int = option(100, "Maximum number of steps.", int, low=1)
    tolerance: float = option(1e-9, TOLERANCE_TEXT, float, above=0)
    fold_length: float = option(
        0.1,
        "Width of a strip of the surface that is as hard to bend as a crease is to fold, relative to the square root of the area. "
        "Small: the roof is as smooth as without creases. Large: each region forms its own cushion.",
        float,
        above=0,
    )
    evenness: Optional[float] = option(
        None,
        "Length over which the curvature varies evenly, relative to the square root of the area. 0: the surface bends as little as "
        "possible; with K < 0 and five or more supports, it may then have branch points. About 0.5: no branch points. None: the "
        "first of 0, 0.55 and 0.4 that leads to a fair surface.",
        float,
        low=0,
    )
    keep: str = option(
        "auto",
        "Part of the drawing that the surface keeps. plan: the plan; heights follow from least bending. shape: the drawn shape, "
        "without its short waves. auto: the shape if it bends far more than its supports require, otherwise the plan.",
        str,
        choices=("auto", "plan", "shape"),
    )
