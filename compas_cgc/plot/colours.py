"""Colour maps and Lambert shading."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from .._figures import matplotlib_module
from ..discrete.arrays import FloatArray
from .view import View
from .view import view_axes

if TYPE_CHECKING:
    from matplotlib.colors import Colormap

__all__ = ["brightness", "diverging_map", "light_direction", "limit_above", "rgba"]

INK = "#1a1a1a"
SURFACE = "#ffffff"
DUMMY_FACE = "#d4d4d4"
DUMMY_EDGE = "#9a9a9a"
SUPPORT = "#d62728"
UNDEFINED = "#b5b5b5"
PALETTE = ("#e8c48f", "#7fa6ad", "#cf8465", "#a7b58b", "#8d93b5", "#d9a5a0", "#b7a58f", "#6f8f86", "#e0d3b8")


def rgba(colour: str) -> FloatArray:
    """Return a colour as red, green, blue and opacity in 0..1 (4,)."""
    return np.array(matplotlib_module("colors").to_rgba(colour))


def diverging_map() -> Colormap:
    """Return the map of signed values: blue below zero, white at zero, red above."""
    stops = ["#08306b", "#2b7bba", "#a6cbe3", "#ffffff", "#f6b29a", "#d6403a", "#7f0d1a"]
    return matplotlib_module("colors").LinearSegmentedColormap.from_list("compas_cgc_signed", stops, N=513)


def limit_above(values: FloatArray) -> float:
    """Return a round number not below any ``|value|``, or 1 if all values are zero; NaN is ignored."""
    size = np.abs(values[np.isfinite(values)])
    largest = float(size.max(initial=0.0))
    if largest == 0.0:
        return 1.0
    decade = 10.0 ** math.floor(math.log10(largest))
    steps = (1.0, 1.2, 1.6, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
    return decade * next((step for step in steps if step * decade >= largest * (1 - 1e-9)), 10.0)


def brightness(normals: FloatArray, view: View, ambient: float) -> FloatArray:
    """Return the brightness of faces under a light over the viewer's left shoulder (Lambert's law); horizontal faces are white.

    Parameters
    ----------
    normals
        ``(m, 3)`` unit normals; both sides of a face are lit equally.
    view
        Direction of view.
    ambient
        Brightness of a face turned away from the light.

    Returns
    -------
    (m,) float64
        Brightness in ambient..1.
    """
    facing = np.where(normals @ view_axes(view)[2] < 0, -1.0, 1.0)
    light = light_direction(view)
    level = max(abs(float(light[2])), 0.5)
    return ambient + (1.0 - ambient) * np.clip(facing * (normals @ light) / level, 0.0, 1.0)


def light_direction(view: View) -> FloatArray:
    """Return the unit vector to the light (3,)."""
    light = np.array([-0.45, 0.65, 0.6]) @ view_axes(view)
    return light / np.linalg.norm(light)
