"""Arguments for goals and for unknown K."""

from __future__ import annotations

import argparse
import json
from typing import Any
from typing import Optional

from ..errors import CGCError
from .arguments import given_length

__all__ = ["add_goals", "goals_of"]


def add_goals(parser: argparse.ArgumentParser) -> None:
    """Add the arguments for goals."""
    group = parser.add_argument_group(
        "goals besides K",
        "Lengths are in model units, or have a unit such as 350mm. PLACE is a region number, a box X0,Y0,X1,Y1 in plan, or\n"
        "the name of a closed curve on the layer CGC::Goals of a .3dm file.",
    )
    group.add_argument("--rise", type=given_length, metavar="H", help="height of the highest vertex above the supports")
    group.add_argument("--height", type=given_length, metavar="Z", help="z coordinate of the highest vertex")
    group.add_argument("--volume", type=float, metavar="V", help="volume between the surface and the mean level of the supports")
    group.add_argument("--area", type=float, metavar="A", help="area of the surface")
    group.add_argument(
        "--above", action="append", default=[], metavar="Z[@PLACE]", help="lower bound of the height, everywhere or over a place"
    )
    group.add_argument("--below", action="append", default=[], metavar="Z", help="upper bound of the height")
    group.add_argument("--edges-in-plan", action="store_true", help="free edges keep their drawn lines in plan")
    group.add_argument("--level-edges", action="store_true", help="free edges keep their drawn lines in plan and stay level")
    group.add_argument(
        "--unknown",
        action="append",
        default=[],
        metavar="REGIONS",
        help="determine K of these regions, such as 0,2 or all; '0,2 ratio + 0.01..0.05' also keeps the ratio of the drawn values, a "
        "positive sign, and K between the two bounds; repeatable",
    )
    group.add_argument("--goal", action="append", default=[], metavar="JSON", help='goal as JSON, such as \'{"kind": "rise", "rise": 4}\'')
    group.add_argument("--sensitivity", action="store_true", help="report how the surface changes with K")


def goals_of(arguments: argparse.Namespace, places: dict[str, Any], units: Optional[str]) -> list[dict[str, Any]]:
    """Return the goals of the arguments as plain data.

    Parameters
    ----------
    arguments
        Arguments of the command line.
    places
        Closed curves of the drawing by name.
    units
        Units of the drawing.

    Raises
    ------
    CGCError
        If a goal is invalid.
    """
    # Imported here so that help texts do not wait for numerical packages.
    from ..model.units import within

    goals: list[dict[str, Any]] = []
    if arguments.rise is not None:
        goals.append({"kind": "rise", "rise": within(arguments.rise, units)})
    if arguments.height is not None:
        goals.append({"kind": "height", "vertices": "crown", "height": within(arguments.height, units)})
    goals += [{"kind": name, name: value} for name in ("volume", "area") if (value := getattr(arguments, name)) is not None]
    goals += [_above(text, places, units) for text in arguments.above]
    goals += [{"kind": "below", "height": _height(text, "--below", units)} for text in arguments.below]
    goals += [{"kind": "edge in plan"}] if arguments.edges_in_plan else []
    goals += [{"kind": "level"}] if arguments.level_edges else []
    goals += [_parsed(text) for text in arguments.goal]
    return [*goals, *_unknown(arguments.unknown)]


def _above(text: str, places: dict[str, Any], units: Optional[str]) -> dict[str, Any]:
    number, at, place = text.partition("@")
    height = _height(number, "--above", units)
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
        known = f"the drawing has {', '.join(places)}" if places else "the drawing has no named curves"
        raise CGCError(
            f"--above {text}: the place {place!r} must be a region number, a box X0,Y0,X1,Y1 or the name of a closed curve; {known}"
        )
    return {"kind": "clearance", "where": where, "height": height}


def _height(text: str, flag: str, units: Optional[str]) -> float:
    from ..model.units import length_of
    from ..model.units import within

    return within(length_of(text, flag), units)


def _parsed(text: str) -> dict[str, Any]:
    try:
        data = json.loads(text)
    except ValueError:
        data = None
    if not isinstance(data, dict):
        raise CGCError(f'--goal must be a JSON object such as {{"kind": "rise", "rise": 4}}, not {text!r}')
    return data


def _unknown(texts: list[str]) -> list[dict[str, Any]]:
    """Return the goals for unknown K; regions given as numbers alone form one goal."""
    # Loaded when it is used, so that help texts do not wait for compiled kernels.
    from ..model.goals.unknown_text import unknown_data

    try:
        found = [unknown_data(text) for text in texts]
    except ValueError as error:
        raise CGCError(f"--unknown: {error}") from None
    plain = [own["regions"] for own in found if len(own) == 2]
    regions = "all" if "all" in plain else [region for own in plain for region in own]
    return [*([{"kind": "unknown", "regions": regions}] if plain else []), *(own for own in found if len(own) > 2)]
