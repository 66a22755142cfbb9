"""Names of goals in messages."""

from __future__ import annotations

from ..constraints import Constraint
from ..constraints import Height
from .inequalities import Above
from .inequalities import Below
from .inequalities import Clearance
from .inequalities import NearPlane
from .inequalities import Within
from .places import EdgeInPlan
from .places import Level
from .places import OnSurface
from .wholes import Area
from .wholes import Length
from .wholes import Rise
from .wholes import Unknown
from .wholes import Volume

__all__ = ["goal_name", "listed"]


def goal_name(goal: Constraint) -> str:
    """Return the name of a goal in messages, with its value in the units that it has."""
    if isinstance(goal, Height):
        return (
            f"the height {goal.height:.6g} of the crown" if isinstance(goal.vertices, str) else f"the height {goal.height:.6g} of vertices"
        )
    numbers: dict[type, tuple[str, str]] = {
        Rise: ("rise", "rise"),
        Volume: ("volume", "volume"),
        Area: ("area", "area"),
        Length: ("length", "length of a path"),
        Above: ("height", "lowest height"),
        Below: ("height", "highest height"),
        Clearance: ("height", "clearance"),
        NearPlane: ("distance", "distance from a plane"),
    }
    for kind, (field, word) in numbers.items():
        if isinstance(goal, kind):
            return f"the {word} {getattr(goal, field):.6g}"
    words: dict[type, str] = {
        EdgeInPlan: "the edge in plan",
        Level: "the level edge",
        OnSurface: "the position on a surface",
        Within: "the outline to stay within",
        Unknown: "the unknown K",
    }
    return next((word for kind, word in words.items() if isinstance(goal, kind)), f"the constraint {type(goal).__name__}")


def listed(names: list[str]) -> str:
    """Return names joined by commas and "and"."""
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]
