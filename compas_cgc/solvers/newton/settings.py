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

    steps: int = option(100, "Maximum number of steps, including those of the elliptic start.", int, low=1)
    tolerance: float = option(1e-12, TOLERANCE_TEXT + " The result is then refined to rounding level.", float, above=0)
    start: str = option(
        "auto",
        "Initial guess. auto: the given shape if its K is near the target, otherwise elliptic steps. elliptic: always "
        "elliptic steps. given: always the given shape, for example after another method.",
        str,
        choices=("auto", "elliptic", "given"),
    )
    anisotropy: float = option(
        5.0,
        "Initial Λ of the elliptic steps, which can represent ratios of the principal curvatures up to Λ². Larger values are faster on "
        "good meshes, smaller values are more robust on bad ones.",
        float,
        low=1,
    )
    shortest: float = option(
        2.0**-10, "Smallest damping factor; if it does not reduce the residual, the solve stalls.", float, above=0, high=1
    )
    measure: str = option(
        "auto",
        MEASURE_TEXT + EXACT_TEXT,
        str,
        choices=MEASURES,
    )
    backend: str = option("auto", "Linear solver.", str, choices=("auto", "superlu", "pardiso"))
