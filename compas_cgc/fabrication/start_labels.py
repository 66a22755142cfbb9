"""Names of curves beyond their starts in plan."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..discrete.arrays import FloatArray
from .drawing import clearance
from .drawing import overlap
from .drawing import text_box

__all__ = ["names_at_starts"]

STEP = 0.5  # by which a name moves away from others, relative to the height
TURNS = np.radians([0.0, 30.0, -30.0, 60.0, -60.0])  # from the direction of a curve to its name, in the order in which they are tried
ROOM = 1.2  # size of the room of a name, relative to the name


def names_at_starts(
    names: Sequence[str], paths: Sequence[FloatArray], height: float, others: Sequence[FloatArray] = (), apart: float = 0.0
) -> FloatArray:
    """Return the middles of names beyond the starts of curves in plan, so that they do not overlap (k, 2) [L].

    Parameters
    ----------
    names
        Names of the curves.
    paths
        Points of each curve in plan ``(p, 2)`` [L].
    height
        Height of the names [L].
    others
        Lower left and upper right corners ``(2, 2)`` of other texts [L].
    apart
        Further distance of the names from the starts [L].
    """
    places, taken = np.empty((len(names), 2)), list(others)
    for k, (name, path) in enumerate(zip(names, paths)):
        back = path[0] - path[1]
        back = back / max(float(np.linalg.norm(back)), np.finfo(float).tiny)
        cosine, sine = np.cos(TURNS), np.sin(TURNS)
        ways = np.column_stack([cosine * back[0] - sine * back[1], sine * back[0] + cosine * back[1]])
        near = [path[0] + (clearance(name, height, way) + apart) * way for way in ways]
        free = [place for place in near if not _covers(name, place, height, taken)]
        places[k] = free[0] if free else near[0]
        while back.any() and _covers(name, places[k], height, taken):
            places[k] += STEP * height * back
        taken.append(text_box(name, places[k], height))
    return places


def _covers(name: str, place: FloatArray, height: float, taken: Sequence[FloatArray]) -> bool:
    """Check whether a name with some room around it overlaps boxes of texts."""
    return any(overlap(text_box(name, place, ROOM * height), other) for other in taken)
