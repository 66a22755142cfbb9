"""Settings of Newton's method."""

from __future__ import annotations

from dataclasses import dataclass

from ..settings import EXACT_TEXT
from ..settings import MEASURE_TEXT
from ..settings import MEASURES
from ..settings import TOLERANCE_TEXT
from ..settings import Settings
from ..settings import documented
from ..settings import option

__all__ = ["NewtonSettings"]


@documented
@dataclass(frozen=True)
class NewtonSettings(Settings):
    """Parameters of Newton's method; none has a unit.

    Examples
    --------
    >>> from compas_cgc import NewtonSettings
    >>> NewtonSettings(tolerance=1e-9).tolerance
    1e-09
    """

    steps: int = option(100, "Most steps to take, those of the elliptic start included.", int, low=1)
    tolerance: float = option(1e-12, TOLERANCE_TEXT + " The result is then polished until rounding stops it.", float, above=0)
    start: str = option(
        "auto",
        "Where to set out from. auto: from the given shape where its K is near the target, else by elliptic steps. elliptic: always "
        "by elliptic steps. given: from the given shape only, as befits the finish after another method.",
        str,
        choices=("auto", "elliptic", "given"),
    )
    anisotropy: float = option(
        5.0,
        "Λ that the elliptic start begins with: it tells ratios of principal curvatures up to Λ² apart. Larger is faster on good "
        "meshes, smaller is steadier on bad ones.",
        float,
        low=1,
    )
    shortest: float = option(
        2.0**-10, "Smallest damping factor; when it does not help either, the solve has stalled.", float, above=0, high=1
    )
    measure: str = option(
        "auto",
        MEASURE_TEXT + EXACT_TEXT,
        str,
        choices=MEASURES,
    )
    backend: str = option("auto", "Linear solver.", str, choices=("auto", "superlu", "pardiso"))
