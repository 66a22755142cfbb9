"""Names of curves beyond their starts in plan."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..discrete.arrays import FloatArray
from .drawing import LETTER_WIDTH
from .drawing import clearance

__all__ = ["names_at_starts"]

STEP = 0.5  # by which a name moves away from others, relative to the height
ROW = 1.2  # distance of names one above the other, relative to the height


def names_at_starts(names: Sequence[str], paths: Sequence[FloatArray], height: float) -> FloatArray:
    """Return the middles of names beyond the starts of curves in plan, so that they do not overlap (k, 2) [L].

    Parameters
    ----------
    names
        Names of the curves.
    paths
        Points of each curve in plan ``(p, 2)`` [L].
    height
        Height of the names [L].
    """
    places = np.empty((len(names), 2))
    widths = np.array([LETTER_WIDTH * len(name) for name in names])
    for k, (name, path) in enumerate(zip(names, paths)):
        back = path[0] - path[1]
        back = back / max(float(np.linalg.norm(back)), np.finfo(float).tiny)
        places[k] = path[0] + clearance(name, height, back) * back
        while back.any():
            apart = np.abs(places[k] - places[:k]) / height
            if not ((apart[:, 0] < 0.5 * (widths[k] + widths[:k] + LETTER_WIDTH)) & (apart[:, 1] < ROW)).any():
                break
            places[k] += STEP * height * back
    return places
