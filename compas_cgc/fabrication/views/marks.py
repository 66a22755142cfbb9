"""Lines and texts of drawings to scale, their layers, and small symbols."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...meshing.polyline import arc_lengths
from ...meshing.polyline import point_at
from ..drawing import Line

__all__ = ["GAP", "LAYERS", "TEXT_HEIGHT", "Label", "Style", "View", "arrow", "cut_for", "dimension", "height_mark", "letters", "outside"]

TEXT_HEIGHT = 2.5  # [mm]
LETTER_WIDTH = 0.85  # relative to the height
TICK = 1.5  # half length of the ticks of dimensions [mm]
MARK_LENGTH = 6.0  # of a height mark [mm]
GAP = 0.6  # between a line and a text in it [mm]
HEIGHTS = (0.8 * TEXT_HEIGHT, 0.6 * TEXT_HEIGHT, 0.48 * TEXT_HEIGHT)  # of the heights of contours
SPINE = np.linspace(-1.0, 1.0, 5)  # points along a text at which its room is measured, relative to half its length
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

    @property
    def box(self) -> FloatArray:
        """Lower left and upper right corner of a level text, with room around it (2, 2) [mm]."""
        half = 0.5 * np.array([letters(self.text, self.height), self.height]) + GAP
        return np.stack([self.place - half, self.place + half])


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
        Returns the smallest distance of points ``(p, 2)`` from whatever the text must not touch [mm]. The place nearest to the middle with
        enough room is taken, at the largest of several heights; without any, the line is whole and has no text.
    """
    length = arc_lengths(line)
    whole = float(length[-1])
    for height in HEIGHTS:
        spine = 0.5 * letters(text, height) * SPINE
        half = float(spine[-1]) + GAP
        within = [s for s in whole * (0.5 + 0.5 * PLACES) if half < s < whole - half]
        middle = next((s for s in within if room(point_at(line, s + spine)) > 0.5 * height + GAP), None)
        if middle is not None:
            break
    else:
        return [line], None
    (before, after), ends = middle + half * SPINE[[0, -1]], point_at(line, middle + half * SPINE[[0, -1]])
    parts = [np.vstack([line[length < before], ends[:1]]), np.vstack([ends[1:], line[length > after]])]
    chord = ends[1] - ends[0]
    angle = upright(float(np.degrees(np.arctan2(chord[1], chord[0]))))
    return parts, Label("CONTOUR", text, ends.mean(axis=0), height, angle)


def outside(line: FloatArray, boxes: Sequence[FloatArray]) -> list[FloatArray]:
    """Return the parts of a polyline (k, 2) outside boxes with their lower left and upper right corners (2, 2) [mm]."""
    parts = [line]
    for low, high in boxes:
        found = []
        for part in parts:
            if (part.max(axis=0) < low).any() or (part.min(axis=0) > high).any():
                found.append(part)
                continue
            # Every segment is within the box between two of its parameters.
            start, step = part[:-1], np.diff(part, axis=0)
            with np.errstate(divide="ignore", invalid="ignore"):
                ends = np.stack([(low - start) / step, (high - start) / step])
            level = step == 0.0
            ends = np.where(level, np.where((start > low) & (start < high), 1.0, np.nan) * np.array([-np.inf, np.inf])[:, None, None], ends)
            first = np.maximum(ends.min(axis=0).max(axis=1), 0.0)
            last = np.minimum(ends.max(axis=0).min(axis=1), 1.0)
            kept = [start[0]]
            for k, (a, b) in enumerate(zip(first.tolist(), last.tolist())):
                if a < b:
                    kept.append(start[k] + a * step[k])
                    found.append(np.array(kept))
                    kept = [start[k] + b * step[k]]
                kept.append(part[k + 1])
            found.append(np.array(kept))
        parts = [part for part in found if np.linalg.norm(np.diff(part, axis=0), axis=1).sum() > 0.0]
    return parts
