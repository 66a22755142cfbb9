"""Goals of the canvas: texts, with the curves that some of them need, and regions whose K is to be found."""

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

MOST = 1000  # goals, and curves of theirs
EVERY = -1  # stands for all regions

GOAL_INPUTS = (
    Input(
        "Goals",
        "G",
        "Text",
        f'What is asked besides K, a text each: rise = 4, or {{"kind": "rise", "rise": 4}}. One of {", ".join(KEYS)}.',
        many=True,
        most=MOST,
        optional=True,
    ),
    Input(
        "Over",
        "O",
        "Curve",
        f"A curve for every goal that is about one ({', '.join(CURVED)}), in their order.",
        many=True,
        most=MOST,
        optional=True,
    ),
    Input(
        "Unknown",
        "U",
        "Integer",
        "Numbers of the regions whose K is to be found; -1 for all. K is then a first guess.",
        many=True,
        most=MOST,
        optional=True,
        low=EVERY,
        high=10**6,
    ),
)


class _Said(NamedTuple):
    place: int
    key: str
    value: str


def drawn_goals(inputs: Mapping[str, Any], tolerance: float) -> list[Drawn]:
    """Return the goals of the inputs as a drawing has them: points and curves with user text.

    Raises
    ------
    Unprocessable
        With a sentence that names the input.
    """
    said, curves = _said(inputs), list(inputs.get("Over") or [])
    asking = [one for one in said if one.key in CURVED]
    # A whole free edge is meant where plan and level come without a curve.
    if not curves:
        asking = [one for one in asking if one.key not in ("plan", "level")]
    if len(asking) != len(curves):
        many = "no curve" if not curves else "one curve" if len(curves) == 1 else f"{len(curves)} curves"
        raise Unprocessable(
            f"input 'Over' has {many} for {len(asking)} goals about one ({', '.join(CURVED)}); connect one for each, in their order"
        )
    places = {one.place: read_curve(curve, "Over", tolerance) for one, curve in zip(asking, curves)}
    return [_drawn(one, places) for one in said]


def goal_options(inputs: Mapping[str, Any], limits: Limits) -> dict:
    """Return the goals that are given as data, and the regions whose K is to be found, as options of a request.

    Raises
    ------
    Unprocessable
        If a text is no JSON.
    """
    data = [_read(text, limits) for text in inputs.get("Goals") or [] if _is_data(text)]
    options: dict = {"goals": data} if data else {}
    regions = [int(region) for region in inputs.get("Unknown") or []]
    if regions:
        options["unknown"] = "all" if EVERY in regions else regions
    return options


def _read(text: str, limits: Limits) -> object:
    try:
        return read_json(text.encode(), limits)
    except BadRequest:
        example = '{"kind": "rise", "rise": 4}'
        raise Unprocessable(f"input 'Goals' has {text!r:.60}, which is no JSON; write rise = 4, or {example}") from None


def _said(inputs: Mapping[str, Any]) -> list[_Said]:
    """Return the goals in words."""
    found = []
    for place, text in enumerate(inputs.get("Goals") or []):
        if not _is_data(text):
            key, _, value = (part.strip() for part in text.replace(":", "=").partition("="))
            if key.casefold() not in KEYS:
                raise Unprocessable(f"input 'Goals' has {text!r:.60}, which says no goal; write rise = 4, with one of {', '.join(KEYS)}")
            found.append(_Said(place, key.casefold(), value))
    return found


def _drawn(said: _Said, curves: Mapping[int, Any]) -> Drawn:
    points = curves.get(said.place)
    kind, points = ("point", np.zeros((1, 3))) if points is None else ("curve", points)
    return Drawn(f"{said.place} of input 'Goals'", kind, points, None, {said.key: said.value})


def _is_data(text: str) -> bool:
    return text.lstrip().startswith("{")
