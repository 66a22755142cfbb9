"""Texts that have no room beside what they name, led aside by a line."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask
from .drawing import Line
from .drawing import Text
from .drawing import overlap
from .drawing import text_box

__all__ = ["LED", "READABLE", "crosses", "led_aside", "sides_of"]

READABLE = 0.35  # height of a text relative to that of its drawing, below which it is led aside
LED = 0.7  # height of a text that is led aside, relative to that of its drawing
SHARES = np.linspace(0.05, 0.95, 19)  # of the way to the middle of a piece, at which a text is tried


def led_aside(
    text: Text, foot: FloatArray, towards: FloatArray, size: float, sides: FloatArray, taken: list[FloatArray]
) -> tuple[list[Line], Text]:
    """Return a text of readable size on the way from what it names to a free place, with its leader; the text itself without room.

    Parameters
    ----------
    text
        The text in its usual place.
    foot
        ``(2,)`` middle of what it names [L].
    towards
        ``(2,)`` middle of the piece [L].
    size
        Height of the led text [L].
    sides
        ``(k, 2, 2)`` segments that it must not touch [L].
    taken
        Boxes of other texts, to which that of this one is added [L].
    """
    for share in SHARES.tolist():
        place = foot + share * (towards - foot)
        box = text_box(text.text, place, size)
        if not crosses(sides, box).any() and not any(overlap(box, other) for other in taken):
            taken.append(box)
            return [Line(text.layer, np.stack([foot, np.clip(foot, box[0], box[1])]))], text._replace(place=place, height=size)
    return [], text


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
