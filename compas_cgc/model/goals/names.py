"""Names of goals in messages."""

from __future__ import annotations

from ...errors import Remedy
from ...errors import Sentence
from ...errors import joined
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
    """Return the name of a goal in messages, with its value in its units; its remedy is to remove the goal."""
    if isinstance(goal, Height):
        return (
            f"the height {goal.height:.6g} of the crown" if isinstance(goal.vertices, str) else f"the height {goal.height:.6g} of vertices"
        )
    numbers: dict[type, tuple[str, str, str]] = {
        Rise: ("rise", "rise", "rise"),
        Volume: ("volume", "volume", "volume"),
        Area: ("area", "area", "area"),
        Length: ("length", "length", "length of a path"),
        Above: ("above", "height", "lowest height"),
        Below: ("below", "height", "highest height"),
        Clearance: ("clearance", "height", "clearance"),
        NearPlane: ("near plane", "distance", "distance from a plane"),
    }
    for own, (kind, field, word) in numbers.items():
        if isinstance(goal, own):
            return Sentence(f"the {word} {getattr(goal, field):.6g}", [Remedy("without", kind)])
    words: dict[type, tuple[str, str]] = {
        EdgeInPlan: ("edge in plan", "the edge in plan"),
        Level: ("level", "the level edge"),
        OnSurface: ("surface", "the position on a surface"),
        Within: ("within", "the outline to stay within"),
        Unknown: ("unknown", "the unknown K"),
    }
    for own, (kind, word) in words.items():
        if isinstance(goal, own):
            return Sentence(word, [Remedy("without", kind)])
    return f"the constraint {type(goal).__name__}"


def listed(names: list[str]) -> str:
    """Return names joined by commas and "and"."""
    return names[0] if len(names) == 1 else joined([joined(names[:-1], ", "), names[-1]], " and ")
