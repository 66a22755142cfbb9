"""Arguments for goals: what is asked of a surface besides K, and which K is to be found."""

from __future__ import annotations

import argparse
import json
from typing import Any
from typing import Optional

from ..errors import CGCError

__all__ = ["add_goals", "goals_of"]


def add_goals(parser: argparse.ArgumentParser) -> None:
    """Add the arguments for goals."""
    group = parser.add_argument_group(
        "goals besides K",
        "Lengths are in model units. PLACE is the number of a region, a box X0,Y0,X1,Y1 in plan, or the name of a closed curve on the "
        "layer CGC::Goals of a .3dm file.",
    )
    group.add_argument("--rise", type=float, metavar="H", help="height of the highest vertex over the supports")
    group.add_argument("--height", type=float, metavar="Z", help="height of the highest vertex")
    group.add_argument("--volume", type=float, metavar="V", help="volume between the surface and the height of the supports")
    group.add_argument("--area", type=float, metavar="A", help="area of the surface")
    group.add_argument(
        "--above", action="append", default=[], metavar="Z[@PLACE]", help="nothing lower than this, everywhere or over a place"
    )
    group.add_argument("--below", action="append", default=[], metavar="Z", help="nothing higher than this")
    group.add_argument("--edges-in-plan", action="store_true", help="free edges stay over the lines that they are drawn along")
    group.add_argument("--level-edges", action="store_true", help="free edges keep their plan and stay level")
    group.add_argument(
        "--unknown", action="append", default=[], metavar="REGION|all", help="find K of this region; may be given several times"
    )
    group.add_argument(
        "--goal", action="append", default=[], metavar="JSON", help='any goal as data, such as \'{"kind": "rise", "rise": 4}\''
    )
    group.add_argument("--sensitivity", action="store_true", help="say what a little more K would do to the surface")


def goals_of(arguments: argparse.Namespace, places: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the goals that the arguments ask for, as plain data.

    Parameters
    ----------
    arguments
        Of the command line.
    places
        Closed lines of the drawing by name.

    Raises
    ------
    CGCError
        If one is not understood.
    """
    goals: list[dict[str, Any]] = []
    if arguments.rise is not None:
        goals.append({"kind": "rise", "rise": arguments.rise})
    if arguments.height is not None:
        goals.append({"kind": "height", "vertices": "crown", "height": arguments.height})
    goals += [{"kind": name, name: value} for name in ("volume", "area") if (value := getattr(arguments, name)) is not None]
    goals += [_above(text, places) for text in arguments.above]
    goals += [{"kind": "below", "height": _number(text, "--below")} for text in arguments.below]
    goals += [{"kind": "edge in plan"}] if arguments.edges_in_plan else []
    goals += [{"kind": "level"}] if arguments.level_edges else []
    goals += [_parsed(text) for text in arguments.goal]
    unknown = _unknown(arguments.unknown)
    return goals if unknown is None else [*goals, {"kind": "unknown", "regions": unknown}]


def _above(text: str, places: dict[str, Any]) -> dict[str, Any]:
    number, at, place = text.partition("@")
    height = _number(number, "--above")
    if not at:
        return {"kind": "above", "height": height}
    if place in places:
        return {"kind": "clearance", "where": places[place], "height": height}
    try:
        box = [float(part) for part in place.split(",")]
        where: Any = int(place) if len(box) == 1 else box
    except ValueError:
        box, where = [], None
    if len(box) not in (1, 4):
        known = f"there are {', '.join(places)}" if places else "the drawing names none"
        raise CGCError(
            f"--above {text}: the place must be a region, a box X0,Y0,X1,Y1 or the name of a closed curve; {known}, not {place!r}"
        )
    return {"kind": "clearance", "where": where, "height": height}


def _number(text: str, flag: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise CGCError(f"{flag} must be a height, such as 2.5 or 2.5@4, not {text!r}") from None


def _parsed(text: str) -> dict[str, Any]:
    try:
        data = json.loads(text)
    except ValueError:
        data = None
    if not isinstance(data, dict):
        raise CGCError(f'--goal must be a JSON object such as {{"kind": "rise", "rise": 4}}, not {text!r}')
    return data


def _unknown(texts: list[str]) -> Optional[object]:
    """Return the regions whose K is to be found, None where all K are given."""
    if not texts:
        return None
    if "all" in texts:
        return "all"
    try:
        return [int(part) for text in texts for part in text.split(",")]
    except ValueError:
        raise CGCError(f"--unknown must be the number of a region, or all, not {texts[0]!r}") from None
