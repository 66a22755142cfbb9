"""The parameters of the paper, by the paper's names."""

from __future__ import annotations

import math
from dataclasses import dataclass
from dataclasses import fields
from typing import Optional

__all__ = ["FlowSettings"]


@dataclass(frozen=True)
class FlowSettings:
    """Parameters of the Gaussian curvature flow.

    Lengths are in model units, so ``filter_radius`` is a length and ``mu0`` a length
    cubed; both come from the mesh when they are ``None``. The other defaults are the
    values that the paper uses throughout (Section 5.8).

    Parameters
    ----------
    steps
        Most steps to take.
    tolerance
        Stop when no |K - K̄| exceeds this part of the largest |K̄| (where all targets
        are zero: of one over the area of the mesh). Zero takes every step.
    mu0
        First trial step length, μ0 [L^3]. Default: 0.2 d̄² / κ, with κ the larger of
        the target's and the start's curvature.
    tau
        Factor from one trial step length to the next, τ in (0, 1).
    xi
        Part of the expected decrease that a step must bring, ξ in (0, 1) (Eq. 28).
    zeta
        How far K may exceed its target in a step, ζ > 1; ``inf`` for no bound (Eq. 29).
        Where K̄ <= 0 the bound is absolute: K - K̄ <= (ζ - 1) times the largest of
        all |K̄| and of the start's |K - K̄|.
    q
        Most reductions of a step length. When none of the trials passes, the last,
        shortest one is taken, as in the paper.
    filter_radius
        Radius d̄ of the filter [L] (Eq. 23); zero for no filter. Default: a third of
        the square root of the area, kept between 3 and 8 mean edges.
    filter_power
        Power p of the filter's weights (Eq. 24).
    s
        Strategy S1: factor on the move of crease vertices, 0 <= s <= 1 (Eq. 27).
        A value set on a crease of the mesh goes before this one.
    e
        Strategy S2: number of first steps in which crease vertices wait. A value set
        on a crease of the mesh goes before this one.
    energy
        ``"steiner"`` (default) or ``"cotangent"`` (the paper's Eq. 15): how the total
        mean curvature in the energy is measured.
    slope
        ``"area"`` (default): the slope in Eq. 28 weighs the curvature error by the
        vertex areas, which makes it the derivative of the energy. ``"unit"``: no
        weights, as Eq. 20 reads word for word; Eq. 28 then hardly ever holds.
    finish
        Let :func:`compas_cgc.solve` take the regions to rounding by Newton's method once
        the flow has shaped the creases, without moving these. The flow itself takes no
        notice of it.
    refilter
        Measure the filter's distances on the present shape (default) or keep those of
        the start.
    """

    steps: int = 3000
    tolerance: float = 1e-6
    mu0: Optional[float] = None
    tau: float = 0.5
    xi: float = 0.01
    zeta: float = 1.1
    q: int = 5
    filter_radius: Optional[float] = None
    filter_power: float = 3.0
    s: float = 0.8
    e: int = 0
    energy: str = "steiner"
    slope: str = "area"
    refilter: bool = True
    finish: bool = True

    def __post_init__(self) -> None:
        rules = {
            "steps": (_is_whole(self.steps) and self.steps >= 1, "a whole number from 1 up"),
            "tolerance": (_is_number(self.tolerance) and self.tolerance >= 0, "a number from 0 up"),
            "mu0": (self.mu0 is None or (_is_number(self.mu0) and self.mu0 > 0), "a positive number, or None"),
            "tau": (_is_number(self.tau) and 0 < self.tau < 1, "between 0 and 1"),
            "xi": (_is_number(self.xi) and 0 < self.xi < 1, "between 0 and 1"),
            "zeta": (_is_number(self.zeta, infinite=True) and self.zeta > 1, "greater than 1"),
            "q": (_is_whole(self.q) and self.q >= 0, "a whole number from 0 up"),
            "filter_radius": (
                self.filter_radius is None or (_is_number(self.filter_radius) and self.filter_radius >= 0),
                "a number from 0 up, or None",
            ),
            "filter_power": (_is_number(self.filter_power) and self.filter_power > 0, "a positive number"),
            "s": (_is_number(self.s) and 0 <= self.s <= 1, "between 0 and 1"),
            "e": (_is_whole(self.e) and self.e >= 0, "a whole number from 0 up"),
            "energy": (self.energy in ("steiner", "cotangent"), "'steiner' or 'cotangent'"),
            "slope": (self.slope in ("area", "unit"), "'area' or 'unit'"),
        }
        for name, (good, rule) in rules.items():
            if not good:
                raise ValueError(f"{name} must be {rule}, not {getattr(self, name)!r}")

    def to_dict(self) -> dict:
        """Return the parameters by name, ready for JSON (an infinite ``zeta`` as ``None``)."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        if math.isinf(self.zeta):
            values["zeta"] = None
        return values


def _is_number(value: object, infinite: bool = False) -> bool:
    return isinstance(value, (int, float)) and not math.isnan(value) and (infinite or math.isfinite(value))


def _is_whole(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)
