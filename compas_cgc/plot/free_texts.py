"""Texts in a drawing that overlap neither each other nor given lines."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from .._figures import matplotlib_module
from ..discrete.arrays import FloatArray
from .colours import INK

__all__ = ["LETTER", "FreeTexts"]

LETTER = 0.62  # width of a character relative to the size of the font
ROW = 1.0  # height of a text relative to the size of the font


class FreeTexts:
    """Texts on axes, each at the first of several places that is free.

    Parameters
    ----------
    axes
        Axes of matplotlib with equal scales.
    scale
        Points of the page per unit of the axes.
    """

    def __init__(self, axes: Any, scale: float):
        self.axes, self.scale = axes, scale
        self.taken: list[Any] = []

    def keep_free(self, points: FloatArray, closed: bool = False) -> None:
        """Keep texts off a polyline (k, 2)."""
        self.taken.append(matplotlib_module("path").Path(np.vstack([points, points[:1]]) if closed else points))

    def put(self, text: str, places: Iterable[FloatArray], size: float, angle: float = 0.0, color: str = INK) -> FloatArray:
        """Write a text centred at the first free of several places (2,), or at the last one, and return the place."""
        half = 0.5 * size / self.scale * np.array([LETTER * len(text), ROW])
        turn = np.radians(angle)
        corners = (
            half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) @ [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
        )
        place = np.zeros(2)
        for place in places:
            box = matplotlib_module("path").Path(place + corners)
            if not any(other.intersects_path(box, filled=False) or box.contains_point(other.vertices[0]) for other in self.taken):
                break
        self.keep_free(place + corners[:-1], closed=True)
        self.axes.text(*place, text, fontsize=size, color=color, ha="center", va="center", rotation=angle)
        return place
