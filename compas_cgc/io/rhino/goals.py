"""Goals in a drawing: points and curves with user text on the goals layer, and named places."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...meshing import Diagnostic
from ...meshing.polyline import points_along
from ...model.constraint_data import constraint_data
from ...model.constraint_data import constraint_of
from ...model.constraints import Constraint
from ...model.constraints import Height
from ...model.goals.inequalities import Above
from ...model.goals.inequalities import Below
from ...model.goals.inequalities import Clearance
from ...model.goals.inequalities import Within
from ...model.goals.numbers import in_plan
from ...model.goals.places import EdgeInPlan
from ...model.goals.places import Level
from ...model.goals.unknown_text import unknown_data
from ...model.goals.unknown_text import unknown_text
from ...model.goals.wholes import Area
from ...model.goals.wholes import Length
from ...model.goals.wholes import Rise
from ...model.goals.wholes import Unknown
from ...model.goals.wholes import Volume
from .sketch import Drawn
from .user_text import user_number

__all__ = ["CURVED", "KEYS", "DrawnGoals", "drawn_goal", "find_goals"]

# Keys of user text: of points, with the field that their number sets, and of closed and other curves.
_AT_POINTS: Mapping[str, dict[str, Any]] = {
    "rise": {"kind": "rise"},
    "height": {"kind": "height", "vertices": "crown"},
    "volume": {"kind": "volume"},
    "area": {"kind": "area"},
    "above": {"kind": "above"},
    "below": {"kind": "below"},
}
_FIELDS = {"above": "height", "below": "height"}
_CLOSED = ("clearance", "within")
_ALONG = ("plan", "level", "length")
KEYS = (*_AT_POINTS, "unknown", *_CLOSED, *_ALONG)
CURVED = (*_CLOSED, *_ALONG)  # goals that require a curve


class DrawnGoals(NamedTuple):
    """Contents of the goals layer."""

    goals: list[Constraint]
    places: tuple[tuple[str, tuple[tuple[float, ...], ...]], ...]  # closed curves by name [L]
    diagnostics: list[Diagnostic]


def find_goals(drawn: list[Drawn], vertices: FloatArray, tolerance: float) -> DrawnGoals:
    """Return the goals in points and curves with user text.

    User text of points anywhere: ``rise``, ``height`` (of the crown), ``volume``, ``area``, ``above`` or ``below`` with a number,
    and ``unknown`` with region numbers or ``all``. User text of closed curves: ``clearance`` with a height, or ``within``. User
    text of curves along vertices: ``plan`` (the edge is fixed in plan), ``level`` or ``length`` with a number. A closed curve
    with a name defines a place of that name.

    Parameters
    ----------
    drawn
        Points, text dots and curves; the user text ``name`` holds the name.
    vertices
        ``(n, 3)`` coordinates [L].
    tolerance
        Largest distance of vertices from a curve [L].
    """
    goals: list[Constraint] = []
    places = []
    diagnostics = []
    for item in drawn:
        closed = item.kind == "curve" and len(item.points) > 3 and bool(np.abs(item.points[0] - item.points[-1]).max() <= tolerance)
        said = [key for key in KEYS if key in item.text]
        try:
            if closed and item.text.get("name"):
                places.append((item.text["name"], tuple(tuple(point) for point in item.points[:-1, :2].tolist())))
            elif not said:
                raise ValueError(f"does not state a goal; give it user text such as rise = 4, with one of {', '.join(KEYS)}")
            goals += [constraint_of(data) for key in said for data in [_data(item, key, closed, vertices, tolerance)]]
        except ValueError as error:
            diagnostics.append(Diagnostic(f"goal {item.label} {error}"))
    return DrawnGoals(goals, tuple(places), diagnostics)


def drawn_goal(goal: Constraint, vertices: FloatArray) -> Optional[Drawn]:
    """Return the drawn object from which a goal can be read back, None for goals that are not drawn."""
    data = constraint_data(goal)
    top = vertices[np.argmax(vertices[:, 2])][None]
    if isinstance(goal, (Rise, Area)) or (isinstance(goal, Volume) and goal.level is None):
        return Drawn("", "point", top, None, {data["kind"]: repr(data[data["kind"]])})
    if isinstance(goal, Height) and isinstance(goal.vertices, str):
        return Drawn("", "point", top, None, {"height": repr(goal.height)})
    if isinstance(goal, (Above, Below)) and isinstance(goal.vertices, str):
        return Drawn("", "point", top, None, {data["kind"]: repr(goal.height)})
    if isinstance(goal, Unknown):
        return Drawn("", "point", top, None, {"unknown": unknown_text(goal)})
    if isinstance(goal, Clearance) and not isinstance(goal.where, (int, np.integer)):
        return _closed(goal.outline(), goal.height, {"clearance": repr(goal.height)})
    if isinstance(goal, Within) and isinstance(goal.vertices, str):
        return _closed(in_plan(goal.points, "points", 3), float(vertices[:, 2].min()), {"within": "yes"})
    if isinstance(goal, (EdgeInPlan, Level)) and isinstance(goal.vertices, str):
        word = "plan" if isinstance(goal, EdgeInPlan) else "level"
        return None if goal.points is not None else Drawn("", "point", top, None, {word: "free"})
    if isinstance(goal, Length):
        return Drawn("", "curve", vertices[list(goal.vertices)], None, {"length": repr(goal.length)})
    return None


def _data(item: Drawn, key: str, closed: bool, vertices: FloatArray, tolerance: float) -> dict[str, Any]:
    """Return one goal of an object as JSON data."""
    if key == "unknown":
        try:
            return unknown_data(item.text[key])
        except ValueError as error:
            raise ValueError(f"has the user text unknown = {item.text[key]!r}: {error}") from None
    if key in ("plan", "level") and item.kind != "curve":
        return {"kind": "edge in plan" if key == "plan" else "level"}
    if key in _AT_POINTS:
        return {**_AT_POINTS[key], _FIELDS.get(key, key): _number(item, key)}
    if item.kind != "curve":
        raise ValueError(f"is a {item.kind}, but {key} requires a curve")
    if key in _CLOSED:
        if not closed:
            raise ValueError(f"is an open curve, but {key} requires a closed curve")
        points = item.points[:-1, :2].tolist()
        return {"kind": "within", "points": points} if key == "within" else {"kind": key, "where": points, "height": _number(item, key)}
    along = list(dict.fromkeys(points_along(vertices, item.points, tolerance).tolist()))
    if len(along) < 2:
        raise ValueError("does not pass through vertices of the mesh; draw it along vertices")
    if key == "length":
        return {"kind": "length", "vertices": along, "length": _number(item, key)}
    if key == "level":
        return {"kind": "level", "vertices": along}
    line = (item.points[:-1] if closed else item.points)[:, :2].tolist()
    return {"kind": "edge in plan", "vertices": along, "points": line, "closed": closed}


def _number(item: Drawn, key: str) -> float:
    number = user_number(item.text, key)
    if number is None:
        raise ValueError(f"has the user text {key} = {item.text[key]!r}; it must be a number")
    return number


def _closed(line: FloatArray, height: float, text: dict[str, str]) -> Drawn:
    ring = np.vstack([line, line[:1]])
    return Drawn("", "curve", np.column_stack([ring[:, :2], np.full(len(ring), height)]), None, text)
