"""Colours of a quantity at the vertices of a mesh, and their legend."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from typing import NamedTuple

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import CGCError
from ...io.rhino.colours import largest
from ...io.rhino.colours import signed_colours
from ...scene.figures import FIGURES

__all__ = ["FigureColours", "check_figure", "figure_colours"]

STEPS = 7  # number of colours in the legend


class FigureColours(NamedTuple):
    """Colours of a quantity."""

    vertices: IntArray  # (n, 3) red, green, blue, 0..255
    limit: float  # largest |value|
    colours: list[Any]  # colours of the legend, for Grasshopper
    legend: list[str]  # values of the legend


def check_figure(show: str) -> None:
    """Raise an error if the quantity is unknown."""
    if show not in FIGURES:
        raise CGCError(f"show must be one of {', '.join(FIGURES)}, not {show!r}")


def figure_colours(figures: Mapping[str, FloatArray], show: str) -> FigureColours:
    """Return the colours of a quantity (n,): blue below zero, white at zero, red above, grey for NaN."""
    import System

    limit = largest(figures[show])
    steps = np.linspace(-limit, limit, STEPS)
    colours = [System.Drawing.Color.FromArgb(*colour) for colour in signed_colours(steps, limit).tolist()]
    return FigureColours(signed_colours(figures[show], limit), limit, colours, [f"{step:.3g}" for step in steps])
