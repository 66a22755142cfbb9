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

    steps: int = option(3000, "Most steps to take.", int, low=1)
    tolerance: float = option(1e-6, TOLERANCE_TEXT + " Zero takes every step.", float, low=0)
    mu0: Optional[float] = option(
        None,
        "First trial step length, μ0 [L^3]. None: 0.2 d̄² / κ, with κ the larger of the target's and the start's curvature.",
        float,
        above=0,
    )
    tau: float = option(0.5, "Factor from one trial step length to the next, τ.", float, above=0, below=1)
    xi: float = option(0.01, "Part of the expected decrease that a step must bring, ξ (Eq. 28).", float, above=0, below=1)
    zeta: float = option(
        1.1,
        "How far K may exceed its target in a step, ζ; infinite for no bound (Eq. 29). Where K̄ <= 0 the bound is absolute: "
        "K - K̄ <= (ζ - 1) times the largest of all |K̄| and of the start's |K - K̄|.",
        float,
        above=1,
        infinite=True,
    )
    q: int = option(
        5,
        "Most reductions of a step length. When none of the trials passes, the last, shortest one is taken, as in the paper.",
        int,
        low=0,
    )
    filter_radius: Optional[float] = option(
        None,
        "Radius d̄ of the filter [L] (Eq. 23); zero for no filter. None: a third of the square root of the area, kept between "
        "3 and 8 mean edges.",
        float,
        low=0,
    )
    filter_power: float = option(3.0, "Power p of the filter's weights (Eq. 24).", float, above=0)
    s: Optional[float] = option(
        None,
        "Strategy S1: creases follow by this factor on their move (Eq. 27). None: 0.8, or 1 where creases wait (e). "
        "A value set on a crease of the mesh goes before this one.",
        float,
        low=0,
        high=1,
    )
    e: int = option(
        0,
        "Strategy S2: creases wait for this many first steps. A value set on a crease of the mesh goes before this one.",
        int,
        low=0,
        alias="delay",
    )
    energy: str = option(
        "steiner",
        "How the total mean curvature in the energy is measured: steiner, or cotangent (the paper's Eq. 15).",
        str,
        choices=("steiner", "cotangent"),
    )
    slope: str = option(
        "area",
        "How the slope in Eq. 28 weighs the curvature error. area: by the vertex areas, which makes it the derivative of the energy. "
        "unit: not, as Eq. 20 reads word for word; Eq. 28 then hardly ever holds.",
        str,
        choices=("area", "unit"),
    )
    refilter: bool = option(True, "Measure the filter's distances on the present shape, not on that of the start.", bool)
    finish: bool = option(
        True,
        "Let a solve take the regions to rounding by Newton's method once the flow has shaped the creases, without moving these. "
        "The flow itself takes no notice of it.",
        bool,
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "s", self.crease_factor)

    @property
    def crease_factor(self) -> float:
        """Factor s of strategy S1 (Eq. 27), by default 0.8, or 1 where creases wait."""
        if self.s is None:
            return 1.0 if self.e else 0.8
        return self.s
