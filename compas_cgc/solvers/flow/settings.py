"""Settings of the flow: the parameters of the paper, by the paper's names."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional

from ..settings import TOLERANCE_TEXT
from ..settings import Settings
from ..settings import documented
from ..settings import option

__all__ = ["FlowSettings"]


@documented
@dataclass(frozen=True)
class FlowSettings(Settings):
    """Parameters of the Gaussian curvature flow.

    Lengths are in model units, so ``filter_radius`` is a length and ``mu0`` a length
    cubed; both come from the mesh when they are ``None``. The other defaults are the
    values that the paper uses throughout (Section 5.8).

    Examples
    --------
    >>> from compas_cgc import FlowSettings
    >>> FlowSettings(s=0.5, steps=200).s
    0.5
    """

    steps: int = option(3000, "Maximum number of steps.", int, low=1)
    tolerance: float = option(1e-6, TOLERANCE_TEXT + " Zero runs all steps.", float, low=0)
    mu0: Optional[float] = option(
        None,
        "First trial step length, μ0 [L^3]. None: 0.2 d̄² / κ, where κ is the largest curvature of the target and of the initial surface.",
        float,
        above=0,
    )
    tau: float = option(0.5, "Reduction factor τ of the step length in the line search.", float, above=0, below=1)
    xi: float = option(0.01, "Required fraction ξ of the expected decrease of the energy (Eq. 28).", float, above=0, below=1)
    zeta: float = option(
        1.1,
        "Largest ratio ζ of K to its target in a step; infinite for no bound (Eq. 29). For K̄ <= 0 the bound is absolute: "
        "K - K̄ <= (ζ - 1) times the largest |K̄| or the largest initial |K - K̄|.",
        float,
        above=1,
        infinite=True,
    )
    q: int = option(
        5,
        "Maximum number of reductions of a step length. If no trial is accepted, the last and shortest one is used, as in the paper.",
        int,
        low=0,
    )
    filter_radius: Optional[float] = option(
        None,
        "Radius d̄ of the filter [L] (Eq. 23); zero for no filter. None: a third of the square root of the area, limited to "
        "3 to 8 mean edge lengths.",
        float,
        low=0,
    )
    filter_power: float = option(3.0, "Exponent p of the filter weights (Eq. 24).", float, above=0)
    s: Optional[float] = option(
        None,
        "Strategy S1: factor on the moves of crease vertices (Eq. 27). None: 0.8, or 1 with a delay of creases. "
        "A value set on a crease of the mesh takes precedence.",
        float,
        low=0,
        high=1,
    )
    e: int = option(
        0,
        "Strategy S2: number of first steps in which creases do not move. A value set on a crease of the mesh takes precedence.",
        int,
        low=0,
        alias="delay",
    )
    energy: str = option(
        "steiner",
        "Measure of the total mean curvature in the energy: steiner, or cotangent (the paper's Eq. 15).",
        str,
        choices=("steiner", "cotangent"),
    )
    slope: str = option(
        "area",
        "Weight of the curvature error in the slope of Eq. 28. area: weighted with the vertex areas, so that the slope is the derivative "
        "of the energy. unit: unweighted, as printed in Eq. 20; Eq. 28 then rarely holds.",
        str,
        choices=("area", "unit"),
    )
    refilter: bool = option(True, "Measure the distances of the filter on the current surface instead of the initial one.", bool)
    finish: bool = option(
        True,
        "After the flow, solve the regions to rounding with Newton's method while the creases are fixed. "
        "The flow itself ignores this option.",
        bool,
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "s", self.crease_factor)

    @property
    def crease_factor(self) -> float:
        """Factor s of strategy S1 (Eq. 27), by default 0.8, or 1 with a delay of creases."""
        if self.s is None:
            return 1.0 if self.e else 0.8
        return self.s
