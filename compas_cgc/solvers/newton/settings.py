"""The parameters of Newton's method."""

from __future__ import annotations

import math
from dataclasses import asdict
from dataclasses import dataclass

from ...linalg import BACKENDS

__all__ = ["NewtonSettings"]

STARTS = ("auto", "elliptic", "given")


@dataclass(frozen=True)
class NewtonSettings:
    """Parameters of Newton's method; none has a unit.

    Parameters
    ----------
    steps
        Most steps to take, those of the elliptic start included.
    tolerance
        Stop when no ``|defect_i - K̄_i A_i|`` exceeds this [rad]. The result is then
        polished until rounding stops it.
    start
        ``"auto"`` (default): from the given shape where its K is near the target, else
        by elliptic steps. ``"elliptic"``: always by elliptic steps. ``"given"``: from the
        given shape only, as befits the finish after another method.
    anisotropy
        Λ >= 1 that the elliptic start begins with: it tells ratios of principal curvatures up
        to Λ² apart. Larger is faster on good meshes, smaller is steadier on bad ones.
    shortest
        Smallest damping factor, in (0, 1]; when it does not help either, the solve has stalled.
    backend
        Linear solver: ``"auto"``, or a name from :data:`compas_cgc.linalg.BACKENDS`.
    """

    steps: int = 60
    tolerance: float = 1e-13
    start: str = "auto"
    anisotropy: float = 5.0
    shortest: float = 2.0**-10
    backend: str = "auto"

    def __post_init__(self) -> None:
        direct = ("auto", *(name for name in BACKENDS if name != "amg"))
        rules = {
            "steps": (isinstance(self.steps, int) and not isinstance(self.steps, bool) and self.steps >= 1, "a whole number from 1 up"),
            "tolerance": (_is_number(self.tolerance) and self.tolerance > 0, "a positive number"),
            "start": (self.start in STARTS, f"one of {', '.join(STARTS)}"),
            "anisotropy": (_is_number(self.anisotropy) and self.anisotropy >= 1, "a number from 1 up"),
            "shortest": (_is_number(self.shortest) and 0 < self.shortest <= 1, "a number in (0, 1]"),
            "backend": (self.backend in direct, f"one of {', '.join(direct)}"),
        }
        for name, (good, rule) in rules.items():
            if not good:
                raise ValueError(f"{name} must be {rule}, not {getattr(self, name)!r}")

    def to_dict(self) -> dict:
        """Return the parameters by name, ready for JSON."""
        return asdict(self)


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
