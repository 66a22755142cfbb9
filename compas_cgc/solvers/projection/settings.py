"""How a projection is steered."""

from __future__ import annotations

import math
from dataclasses import asdict
from dataclasses import dataclass

__all__ = ["AUTO", "KEEP", "ProjectionSettings"]

# What nearness weighs in plan and in height, by what the designer wants to keep.
KEEP = {"plan": (0.1, 1e-6), "shape": (1.0, 1.0), "nothing": (1e-4, 1e-6)}
AUTO = "auto"
MEASURES = ("defect", "smooth")


@dataclass(frozen=True)
class ProjectionSettings:
    """Parameters of the projection; none of them has a unit, so they fit any model.

    Parameters
    ----------
    steps
        Most steps to take.
    tolerance
        Stop when no |K - K̄| exceeds this part of the largest |K̄| (where all targets
        are zero: of one over the area of the mesh), or when what is left is rounding.
    keep
        What of the drawing the surface keeps: its ``"plan"``, seen along the direction that the
        mesh faces, while heights go where the surface bends least; its ``"shape"``, plan
        and heights; or ``"nothing"`` but the supports. With ``"auto"`` its shape where
        it bends far more than its supports make it, and its plan elsewhere.
    measure
        How K is read off the mesh: by angle ``"defect"`` over area, the paper's; or ``"smooth"``, by
        that less what the layout of the mesh puts into it, so that an irregular mesh leaves no wrinkles.
    nearness
        Weight of what is kept. Only its ratio to ``smoothness`` counts.
    smoothness
        Length over which bending outweighs nearness, as a part of the square root of the
        area, where ``nearness`` is one. Small: the surface keeps to the drawing and K
        is mended on the spot. Large: it bends as a whole, like a plate.
    crease_stiffness
        Bending stiffness across creases, as a part of that elsewhere: zero lets them
        fold freely, one takes no notice of them.
    seed_height
        Where the input is flat no small move changes K; there a low dome or saddle is
        put on it first. No higher than this part of the mesh's diameter on an open boundary, where
        flat and steep surfaces have the same K. Zero: no such start.
    retry
        When the straight way to the targets stalls, try less smoothness, then more of it,
        and at last targets that come from the curvature of the start in stages.
    """

    steps: int = 300
    tolerance: float = 1e-12
    keep: str = AUTO
    measure: str = "defect"
    nearness: float = 1.0
    smoothness: float = 0.1
    crease_stiffness: float = 0.1
    seed_height: float = 0.15
    retry: bool = True

    def __post_init__(self) -> None:
        rules = {
            "steps": (isinstance(self.steps, int) and not isinstance(self.steps, bool) and self.steps >= 1, "a whole number from 1 up"),
            "tolerance": (_is_number(self.tolerance) and self.tolerance >= 0, "a number from 0 up"),
            "keep": (isinstance(self.keep, str) and self.keep in (AUTO, *KEEP), f"one of {', '.join((AUTO, *KEEP))}"),
            "measure": (self.measure in MEASURES, f"one of {', '.join(MEASURES)}"),
            "nearness": (_is_number(self.nearness) and self.nearness > 0, "a positive number"),
            "smoothness": (_is_number(self.smoothness) and self.smoothness > 0, "a positive number"),
            "crease_stiffness": (_is_number(self.crease_stiffness) and 0 <= self.crease_stiffness <= 1, "between 0 and 1"),
            "seed_height": (_is_number(self.seed_height) and self.seed_height >= 0, "a number from 0 up"),
            "retry": (isinstance(self.retry, bool), "True or False"),
        }
        for name, (good, rule) in rules.items():
            if not good:
                raise ValueError(f"{name} must be {rule}, not {getattr(self, name)!r}")

    def to_dict(self) -> dict:
        """Return the parameters by name, ready for JSON."""
        return asdict(self)


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
