"""Legends of pictures: scale, north and K, and the colour bar of an error map."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING
from typing import Optional

from .._figures import matplotlib_module
from ..discrete.arrays import FloatArray
from ..fabrication.front_view import PLAN
from ..fabrication.picture_key import Key
from ..fabrication.picture_key import draw_key
from .colours import INK
from .colours import diverging_map
from .layout import SIZE
from .layout import points_per_length
from .layout import write

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["FOOT", "SIDE", "add_key", "colour_bar", "per_area"]

FOOT = 0.42  # space for a key below a panel with a caption [in]
BELOW = 23.0  # distance of the key from a panel, below its caption [pt]
CAPITALS = 0.72  # height of capitals relative to the size of the font
SIDE = 0.85  # space for a colour bar to the right of a panel [in]


def add_key(
    ax: Axes,
    key: Key,
    axes: FloatArray = PLAN,
    below: float = BELOW,
    scale: Optional[float] = None,
    size: float = SIZE - 1,
    at: float = 0.0,
) -> None:
    """Draw the key of a picture below its axes.

    Parameters
    ----------
    ax
        Axes with equal scales.
    key
        Scale, north, and further words.
    axes
        ``(3, 3)`` unit vectors to the right, upwards, and to the viewer.
    below
        Distance of the key from the lower edge of the axes, downwards [pt].
    scale
        Points on paper per unit of length of the surface. Default: those of the axes.
    size
        Font size [pt].
    at
        Start of the key, relative to the width of the axes.
    """
    transforms, lines = matplotlib_module("transforms"), matplotlib_module("lines")
    figure = ax.figure.figure
    width = 72.0 * float(ax.get_position().width * figure.get_size_inches()[0])
    marks = draw_key(key, width, scale or points_per_length(ax), CAPITALS * size, axes)
    start = transforms.ScaledTranslation(at, 0.0, ax.transAxes)
    points = transforms.Affine2D().translate(0.0, -below).scale(1.0 / 72.0) + figure.dpi_scale_trans + start
    for line in marks.lines:
        ax.add_artist(lines.Line2D(*line.T, transform=points, color=INK, lw=0.9, solid_capstyle="butt", clip_on=False))
    for text, place in marks.texts:
        ax.text(float(place[0]), float(place[1]), text, transform=points, color=INK, fontsize=size, ha="left", va="center", clip_on=False)


def colour_bar(ax: Axes, limit: float, label: str) -> None:
    """Add the colour bar to the right of axes."""
    norm = matplotlib_module("colors").Normalize(-limit, limit)
    mappable = matplotlib_module("cm").ScalarMappable(norm, diverging_map())
    width, height = ax.figure.figure.get_size_inches() * (ax.get_position().width, ax.get_position().height)
    tall = min(0.8 * height, 1.8) / height
    place = ax.inset_axes((1.0 + 0.08 / width, 0.5 - tall / 2, 0.09 / width, tall))
    ticks = [-limit, -limit / 2, 0.0, limit / 2, limit]
    power = math.floor(math.log10(limit))
    power = 0 if -3 < power < 4 else power
    bar = ax.figure.colorbar(mappable, cax=place, ticks=ticks)
    bar.ax.set_yticklabels([f"{tick / 10.0**power:.4g}".replace("-", "\N{MINUS SIGN}") for tick in ticks])
    bar.ax.tick_params(labelsize=SIZE - 2, length=2, width=0.5, pad=2, colors=INK)
    bar.outline.set_linewidth(0.5)
    for text, height, offset in ((label, 0.0, -12), (rf"$\times 10^{{{power}}}$" if power else "", 1.0, 6)):
        write(bar.ax, text, (0.0, height), (0.0, offset), va="center", fontsize=SIZE - 1)


def per_area(unit: Optional[str]) -> str:
    """Return the unit of curvature in brackets, empty if the unit of length is unknown."""
    return f" [1/{unit}²]" if unit else ""
