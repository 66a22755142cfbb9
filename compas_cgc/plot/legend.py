"""Colour bar of an error map."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING
from typing import Optional

from .._figures import matplotlib_module
from .colours import INK
from .colours import diverging_map
from .layout import SIZE
from .layout import write

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["SIDE", "colour_bar", "per_area"]

SIDE = 0.85  # space for a colour bar to the right of a panel [in]


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
