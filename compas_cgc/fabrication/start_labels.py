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
        places[k] = path[0] + (clearance(name, height, back) + apart) * back
        while back.any() and any(overlap(text_box(name, places[k], ROOM * height), other) for other in taken):
            places[k] += STEP * height * back
        taken.append(text_box(name, places[k], height))
    return places
