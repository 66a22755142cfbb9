"""Points of a plan that are set out on site, and chains of dimensions between them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...discrete.arrays import FloatArray
from ...meshing.boundary import corners_of
from ..drawing import Line
from .marks import GAP
from .marks import TEXT_HEIGHT
from .marks import Label
from .marks import dimension
from .marks import letters

if TYPE_CHECKING:
    from .projections import Shape

__all__ = ["chain", "set_out"]

TURN = np.cos(np.radians(30.0))  # cosine of the turn of a crease in plan from which its vertex is a kink
SAGITTA = 0.01  # of a part of a crease, relative to its chord, from which it is curved and its farthest point is set out
SMALL = 0.8 * TEXT_HEIGHT  # height of the texts [mm]


def set_out(shape: Shape) -> FloatArray:
    """Return the points (k, 3) that fix the plan [L].

    These are corners of outlines, ends and kinks of creases, crowns of curved parts between them, extremes of outlines without corners,
    and single supports.
    """
    plan = shape.vertices * [1.0, 1.0, 0.0]
    found = [plan[shape.held_points]]
    for path in (*shape.outlines, *shape.creases):
        line = plan[path]
        if path[0] == path[-1]:
            corners = np.flatnonzero(corners_of(line[:-1]))
            if len(corners) < 2:
                extremes = [own(line[:, axis]) for own in (np.argmin, np.argmax) for axis in (0, 1)]
                found += [line[corners], line[extremes]]
                continue
            # From corner to corner a closed line is like an open one.
            line = np.roll(line[:-1], -corners[0], axis=0)
            line = np.vstack([line, line[:1]])
            ends = np.r_[corners - corners[0], len(line) - 1]
            found += [line[ends], *(_crown(line[a : b + 1]) for a, b in zip(ends, ends[1:]))]
            continue
        sides = np.diff(line, axis=0)
        sides /= np.maximum(np.linalg.norm(sides, axis=1, keepdims=True), np.finfo(float).tiny)
        kinks = 1 + np.flatnonzero(np.einsum("ki,ki->k", sides[1:], sides[:-1]) < TURN)
        ends = np.r_[0, kinks, len(path) - 1]
        found += [line[ends], *(_crown(line[a : b + 1]) for a, b in zip(ends, ends[1:]))]
    return np.concatenate(found)


def _crown(line: FloatArray) -> FloatArray:
    """Return the point of a line that is farthest from its chord (1, 3), by a parabola through three vertices; none if it is straight."""
    chord = line[-1] - line[0]
    length = float(np.linalg.norm(chord))
    along = chord / length
    aside = np.array([-along[1], along[0], 0.0])
    s, off = (line - line[0]) @ along, (line - line[0]) @ aside
    top = int(np.argmax(np.abs(off)))
    if not abs(off[top]) > SAGITTA * length:
        return line[:0]
    a, b, c = np.polyfit(s[top - 1 : top + 2], off[top - 1 : top + 2], 2)
    crown = -0.5 * b / a
    return (line[0] + crown * along + (c + 0.5 * b * crown) * aside)[None]


def chain(places: FloatArray, texts: list[str], start: FloatArray, along: FloatArray, beside: float) -> tuple[list[Line], list[Label]]:
    """Return a chain of dimensions between places on a line, to the right of its direction.

    A text that is wider than its part stands on the far side of the line, if there is room, and is left out otherwise.

    Parameters
    ----------
    places
        ``(k,)`` increasing distances from the start [mm].
    texts
        Text of every part, one less than places.
    start
        ``(2,)`` start of the line [mm].
    along
        ``(2,)`` unit direction.
    beside
        Distance of the chain from the line [mm].
    """
    lines, labels = list[Line](), list[Label]()
    far = -np.inf
    right = np.array([along[1], -along[0]])
    for first, last, text in zip(places, places[1:], texts):
        drawn, label = dimension(start + first * along, start + last * along, text, beside)
        lines += drawn
        room, middle = 0.5 * letters(text, SMALL) + GAP, 0.5 * float(first + last)
        label = label._replace(height=SMALL)
        if 2.0 * room <= last - first:
            labels.append(label)
        elif middle - room > far:
            labels.append(label._replace(place=label.place + 1.6 * TEXT_HEIGHT * right))
            far = middle + room
    return lines, labels
