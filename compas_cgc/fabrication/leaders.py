"""Texts that have no room beside what they name, led aside by a line."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Sequence

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask
from .drawing import Line
from .drawing import Text
from .drawing import overlap
from .drawing import text_box

__all__ = ["LED_SIZES", "READABLE", "around", "crosses", "is_free", "led_aside", "sides_of", "towards"]

READABLE = 0.35  # height of a text relative to that of its drawing, below which it is led aside
LED_SIZES = np.array([0.7, 0.5, READABLE])  # heights of a text that is led aside, relative to that of its drawing
SHARES = np.linspace(0.05, 0.95, 19)  # of the way to the middle of a piece, at which a text is tried
RING = 2.5  # distance of rings, relative to the height of the text
RINGS = 12  # around what has no room for its name, on which the name is tried
DIRECTIONS = np.column_stack([np.cos(np.arange(24) * np.pi / 12.0), np.sin(np.arange(24) * np.pi / 12.0)])  # of places on a ring


def led_aside(
    text: Text, foot: FloatArray, places: Sequence[FloatArray], sizes: FloatArray, sides: FloatArray, taken: Sequence[FloatArray]
) -> tuple[list[Line], Text]:
    """Return a text of readable size in the first free place, with its leader; the text itself without room.

    Parameters
    ----------
    text
        The text in its usual place.
    foot
        ``(2,)`` point on what it names [L].
    places
        Points ``(2,)`` at which it is tried, in order [L].
    sizes
        Heights of the led text, the first for which there is room [L].
    sides
        ``(k, 2, 2)`` segments that it must not touch [L].
    taken
        Boxes of other texts [L].
    """
    for place, size in ((place, size) for size in sizes.tolist() for place in places):
        box = text_box(text.text, place, size)
        if is_free(box, sides, taken):
            return [Line(text.layer, np.stack([foot, np.clip(foot, box[0], box[1])]))], text._replace(place=place, height=size)
    return [], text


def is_free(box: FloatArray, sides: FloatArray, taken: Sequence[FloatArray]) -> bool:
    """Check whether a box (2, 2) touches no segments (k, 2, 2) and no other boxes."""
    return not crosses(sides, box).any() and not any(overlap(box, other) for other in taken)


def towards(foot: FloatArray, middle: FloatArray) -> list[FloatArray]:
    """Return places (2,) on the way from a foot to the middle of its piece [L]."""
    return [foot + share * (middle - foot) for share in SHARES.tolist()]


def around(foot: FloatArray, text: str, size: float, sheet: FloatArray) -> list[FloatArray]:
    """Return places (2,) on rings around a foot at which a text of a size lies within a sheet of a length and width (2,) [L]."""
    places = (foot + RING * ring * size * direction for ring in range(1, RINGS + 1) for direction in DIRECTIONS)
    boxes = ((place, text_box(text, place, size)) for place in places)
    return [place for place, (low, high) in boxes if (low >= 0.0).all() and (high <= sheet).all()]


def crosses(sides: FloatArray, box: FloatArray) -> Mask:
    """Return the mask of segments (k, 2, 2) that meet a box (2, 2)."""
    start, step = sides[:, 0], sides[:, 1] - sides[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        at = (box[:, None] - start) / step  # (2, k, 2) parameters at which segments enter and leave the box along x and y
    parallel = step == 0.0
    within = (start >= box[0]) & (start <= box[1])
    enter = np.where(parallel, np.where(within, 0.0, np.inf), at.min(axis=0))
    leave = np.where(parallel, 1.0, at.max(axis=0))
    return np.asarray(np.maximum(enter.max(axis=1), 0.0) <= np.minimum(leave.min(axis=1), 1.0))


def sides_of(loops: Iterable[FloatArray]) -> FloatArray:
    """Return the segments (k, 2, 2) of closed loops (p, 2)."""
    return np.concatenate([np.stack([loop, np.roll(loop, -1, axis=0)], axis=1) for loop in loops])
