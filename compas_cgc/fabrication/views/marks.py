"""Lines and texts of drawings to scale, their layers, and small symbols."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ..drawing import Line

__all__ = ["LAYERS", "TEXT_HEIGHT", "Label", "Style", "View", "arrow", "cut_for", "dimension", "height_mark", "letters"]

TEXT_HEIGHT = 2.5  # [mm]
LETTER_WIDTH = 0.85  # relative to the height
TICK = 1.5  # half length of the ticks of dimensions [mm]
MARK_LENGTH = 6.0  # of a height mark [mm]
GAP = 0.6  # between a line and a text in it [mm]
# Places of texts on lines, from the middle towards the ends in turn.
PLACES = np.repeat(np.linspace(0.0, 0.95, 20), 2)[1:] * np.tile([-1.0, 1.0], 20)[1:]


class Style(NamedTuple):
    """Appearance of a layer."""

    colour: tuple[int, int, int]  # RGB
    width: float  # of lines [mm]
    dashes: tuple[float, ...] = ()  # lengths of dashes and gaps [mm]; empty: continuous


LAYERS = {
    "FRAME": Style((0, 0, 0), 0.35),
    "OUTLINE": Style((0, 0, 0), 0.5),
    "CUT": Style((0, 0, 0), 0.7),
    "CREASE": Style((30, 80, 200), 0.35),
    "BEYOND": Style((110, 110, 110), 0.18),
    "CONTOUR": Style((160, 110, 60), 0.13),
    "SUPPORT": Style((200, 30, 30), 0.7),
    "SECTION": Style((20, 130, 140), 0.25, (6.0, 1.0, 1.0, 1.0)),
    "GROUND": Style((110, 110, 110), 0.18, (2.0, 1.0)),
    "DIMENSION": Style((90, 90, 90), 0.13),
    "REGION": Style((30, 80, 200), 0.18),
    "TEXT": Style((0, 0, 0), 0.18),
}


class Label(NamedTuple):
    """A line of text, centred at a point."""

    layer: str
    text: str
    place: FloatArray  # (2,) [mm]
    height: float = TEXT_HEIGHT  # [mm]
    angle: float = 0.0  # counterclockwise [deg]


class View(NamedTuple):
    """A plan, section or elevation in millimetres of the sheet, with its lower left corner at the origin."""

    name: str
    lines: list[Line]
    labels: list[Label]
    size: FloatArray  # (2,) [mm]

    def moved(self, by: FloatArray) -> View:
        """Return the view at another place."""
        lines = [line._replace(points=line.points + by) for line in self.lines]
        return self._replace(lines=lines, labels=[own._replace(place=own.place + by) for own in self.labels])


def letters(text: str, height: float = TEXT_HEIGHT) -> float:
    """Return the approximate width of a text [mm]."""
    return LETTER_WIDTH * height * len(text)


def dimension(start: FloatArray, end: FloatArray, text: str, beside: float) -> tuple[list[Line], Label]:
    """Return the lines and the text of a dimension between two points (2,) [mm], to the right of its direction by `beside` [mm]."""
    along = (end - start) / max(float(np.linalg.norm(end - start)), 1e-9)
    right = np.array([along[1], -along[0]])
    a, b = start + beside * right, end + beside * right
    slash = TICK * (along + right) / np.sqrt(2.0)
    ends = [np.stack([at + 0.25 * beside * right, own + TICK * right]) for at, own in ((start, a), (end, b))]
    lines = [np.stack([a, b]), *ends, *(np.stack([own - slash, own + slash]) for own in (a, b))]
    angle = float(np.degrees(np.arctan2(along[1], along[0])))
    place = 0.5 * (a + b) - 0.8 * TEXT_HEIGHT * right
    return [Line("DIMENSION", own) for own in lines], Label("DIMENSION", text, place, angle=upright(angle))


def upright(angle: float) -> float:
    """Return the angle of a text along a direction that is readable from below or from the right [deg]."""
    return angle - 180.0 if angle > 90.5 else angle + 180.0 if angle <= -89.5 else angle


def height_mark(at: FloatArray, text: str) -> tuple[list[Line], Label]:
    """Return a line to the left of a point (2,), with a triangle and the height above [mm]."""
    tip = at - [0.5 * MARK_LENGTH, 0.0]
    triangle = tip + np.array([[0.0, 0.0], [1.0, 1.6], [-1.0, 1.6]])
    line = np.stack([at - [MARK_LENGTH, 0.0], at])
    place = at + [-MARK_LENGTH - 0.6 - 0.5 * letters(text), 0.0]
    return [Line("DIMENSION", line), Line("DIMENSION", triangle, closed=True)], Label("DIMENSION", text, place)


def arrow(start: FloatArray, end: FloatArray, layer: str) -> list[Line]:
    """Return an arrow between two points (2,) [mm]."""
    along = (end - start) / max(float(np.linalg.norm(end - start)), 1e-9)
    side = np.array([-along[1], along[0]])
    head = np.stack([end - 3.0 * along + side, end, end - 3.0 * along - side])
    return [Line(layer, np.stack([start, end])), Line(layer, head, closed=True)]


def cut_for(line: FloatArray, text: str, room: Callable[[FloatArray], float]) -> tuple[list[FloatArray], Optional[Label]]:
    """Return the parts of a polyline (k, 2) beside a text on it, and the text along the line [mm].

    Parameters
    ----------
    line
        Points ``(k, 2)`` [mm].
    text
        The text.
    room
        Returns the distance of a point (2,) from whatever the text must not touch [mm]. The place nearest to the middle with enough room is
        taken; without any, the line is whole and has no text.
    """
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    half, whole = 0.5 * letters(text) + GAP, float(length[-1])

    def at(s: float) -> FloatArray:
        return np.array([np.interp(s, length, line[:, axis]) for axis in (0, 1)])

    within = [s for s in whole * (0.5 + 0.5 * PLACES) if half < s < whole - half]
    middle = next((s for s in within if room(at(s)) > half), None)
    if middle is None:
        return [line], None
    before, after = middle - half, middle + half
    parts = [np.vstack([line[length < before], at(before)]), np.vstack([at(after), line[length > after]])]
    chord = at(after) - at(before)
    angle = upright(float(np.degrees(np.arctan2(chord[1], chord[0]))))
    return parts, Label("CONTOUR", text, 0.5 * (at(before) + at(after)), 0.8 * TEXT_HEIGHT, angle)
