"""Goals on the canvas: texts with curves where required, and regions with unknown K."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from typing import NamedTuple

import numpy as np

from ...io.rhino.goals import CURVED
from ...io.rhino.goals import KEYS
from ...io.rhino.sketch import Drawn
from ..api.decoding import read_json
from ..errors import BadRequest
from ..errors import Unprocessable
from ..limits import Limits
from .geometry import read_curve
from .schema import Input

__all__ = ["GOAL_INPUTS", "drawn_goals", "goal_options"]

MAX_GOALS = 1000  # also the largest number of curves
ALL_REGIONS = -1

GOAL_INPUTS = (
    Input(
        "Goals",
        "G",
        "Text",
        f'Requirements besides K, one text each: rise = 4, or {{"kind": "rise", "rise": 4}}. One of {", ".join(KEYS)}.',
        many=True,
        most=MAX_GOALS,
        optional=True,
    ),
    Input(
        "Over",
        "O",
        "Curve",
        f"One curve per goal that needs one ({', '.join(CURVED)}), in the order of these goals.",
        many=True,
        most=MAX_GOALS,
        optional=True,
    ),
    Input(
        "Unknown",
        "U",
        "Integer",
        "Numbers of the regions with unknown K; -1 for all. K is then the initial guess.",
        many=True,
        most=MAX_GOALS,
        optional=True,
        low=ALL_REGIONS,
        high=10**6,
    ),
)


class _GoalText(NamedTuple):
    place: int
    key: str
    value: str


def drawn_goals(inputs: Mapping[str, Any], tolerance: float) -> list[Drawn]:
    """Return the goals of the inputs in the form of a drawing: points and curves with user text.

    Raises
    ------
    Unprocessable
        If a goal cannot be read, or the number of curves does not match.
    """
    goals, curves = _goal_texts(inputs), list(inputs.get("Over") or [])
    asking = [one for one in goals if one.key in CURVED]
    # Without a curve, plan and level apply to the whole free edge.
    if not curves:
        asking = [one for one in asking if one.key not in ("plan", "level")]
    if len(asking) != len(curves):
        many = "no curve" if not curves else "one curve" if len(curves) == 1 else f"{len(curves)} curves"
        raise Unprocessable(
            f"input 'Over' has {many}, but {len(asking)} goals need one ({', '.join(CURVED)}); connect one per goal, in their order"
        )
    places = {one.place: read_curve(curve, "Over", tolerance) for one, curve in zip(asking, curves)}
    return [_drawn(one, places) for one in goals]


def goal_options(inputs: Mapping[str, Any], limits: Limits) -> dict:
    """Return the goals given as JSON and the regions with unknown K as options of a request.

    Raises
    ------
    Unprocessable
        If a text is not valid JSON.
    """
    data = [_read(text, limits) for text in inputs.get("Goals") or [] if _is_data(text)]
    options: dict = {"goals": data} if data else {}
    regions = [int(region) for region in inputs.get("Unknown") or []]
    if regions:
        options["unknown"] = "all" if ALL_REGIONS in regions else regions
    return options


def _read(text: str, limits: Limits) -> object:
    try:
        return read_json(text.encode(), limits)
    except BadRequest:
        example = '{"kind": "rise", "rise": 4}'
        raise Unprocessable(f"input 'Goals' has {text!r:.60}, which is not valid JSON; write rise = 4, or {example}") from None


def _goal_texts(inputs: Mapping[str, Any]) -> list[_GoalText]:
    """Return the goals in the form key = value."""
    found = []
    for place, text in enumerate(inputs.get("Goals") or []):
        if not _is_data(text):
            key, _, value = (part.strip() for part in text.replace(":", "=").partition("="))
            if key.casefold() not in KEYS:
                raise Unprocessable(f"input 'Goals' has {text!r:.60}, which is not a goal; write rise = 4, with one of {', '.join(KEYS)}")
            found.append(_GoalText(place, key.casefold(), value))
    return found


def _drawn(goal: _GoalText, curves: Mapping[int, Any]) -> Drawn:
    points = curves.get(goal.place)
    kind, points = ("point", np.zeros((1, 3))) if points is None else ("curve", points)
    return Drawn(f"{goal.place} of input 'Goals'", kind, points, None, {goal.key: goal.value})


def _is_data(text: str) -> bool:
    return text.lstrip().startswith("{")
