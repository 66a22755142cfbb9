"""Plans, sections and elevations as DXF, PDF and SVG to scale."""

from __future__ import annotations

import os
from collections import defaultdict
from typing import TYPE_CHECKING
from typing import Any
from typing import Union

import numpy as np

from .._atomic_write import replacing
from .._figures import matplotlib_module
from .._figures import new_figure
from .._figures import save
from ..fabrication.dxf import DARK_LEVEL
from ..fabrication.dxf import new_document
from ..fabrication.dxf import show_all
from ..fabrication.figures import metres
from ..fabrication.views import ViewSheet
from ..fabrication.views.marks import LAYERS
from ._files import suffix_among
from .formats import OUTPUTS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["sheet_figure", "write_views"]

INCH = 25.4  # [mm]
POINT = INCH / 72.0  # [mm]
CAPITALS = 0.72  # height of capitals relative to the size of the font


def write_views(path: Union[str, os.PathLike], drawn: ViewSheet) -> None:
    """Write a sheet in the format of the suffix, atomically.

    Parameters
    ----------
    path
        A .pdf or .svg in the size of the sheet, or a .dxf in the units and size of the surface, to be plotted at the scale of the sheet.
    drawn
        Result of :func:`compas_cgc.fabrication.draw_views`.

    Raises
    ------
    FileError
        If the file cannot be written.
    CGCError
        If a package that the format requires is missing.
    """
    suffix = suffix_among(path, OUTPUTS["drawings"], "drawings")
    if suffix != ".dxf":
        save(sheet_figure(drawn), path)
        return
    with replacing(path) as temporary:
        _write_dxf(str(temporary), drawn)


def _write_dxf(path: str, drawn: ViewSheet) -> None:
    document = new_document(drawn.units)
    from ezdxf.enums import TextEntityAlignment

    size = drawn.scale / (1000.0 * metres(drawn.units))  # of a millimetre of the sheet
    document.header["$LTSCALE"] = size
    for name, style in LAYERS.items():
        layer = document.layers.add(name, lineweight=round(100 * style.width))
        if style.dashes:
            pattern = [sum(style.dashes), *(length if k % 2 == 0 else -length for k, length in enumerate(style.dashes))]
            document.linetypes.add(f"CGC_{name}", pattern, description=name.lower())
            layer.dxf.linetype = f"CGC_{name}"
        # Colour 7 contrasts with the screen background, light or dark.
        if max(style.colour) < DARK_LEVEL:
            layer.color = 7
        else:
            layer.rgb = style.colour
    space = document.modelspace()
    for line in drawn.lines:
        space.add_lwpolyline((size * line.points).tolist(), close=line.closed, dxfattribs={"layer": line.layer})
    for label in drawn.labels:
        if label.text and label.height > 0:
            entity = space.add_text(label.text, height=size * label.height, rotation=label.angle, dxfattribs={"layer": label.layer})
            entity.set_placement(tuple((size * label.place).tolist()), align=TextEntityAlignment.MIDDLE_CENTER)
    show_all(document, size * np.array([(0.0, 0.0), drawn.size]))
    document.saveas(path)


def sheet_figure(drawn: ViewSheet) -> Figure:
    """Return a figure in which a millimetre of the sheet is a millimetre on paper.

    Parameters
    ----------
    drawn
        Result of :func:`compas_cgc.fabrication.draw_views`.

    Raises
    ------
    CGCError
        If matplotlib is not installed.
    """
    collections = matplotlib_module("collections")
    width, height = drawn.size
    figure = new_figure(width / INCH, height / INCH)
    axes: Any = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(0.0, width)
    axes.set_ylim(0.0, height)
    paths = defaultdict(list)
    for line in drawn.lines:
        paths[line.layer].append(np.vstack([line.points, line.points[:1]]) if line.closed else line.points)
    for name, style in LAYERS.items():
        # Dashes are in widths of the line.
        dashes = (0, tuple(length / style.width for length in style.dashes)) if style.dashes else "solid"
        own = {"colors": [_rgb(style.colour)], "linewidths": style.width / POINT, "linestyles": [dashes]}
        axes.add_collection(collections.LineCollection(paths[name], capstyle="round", **own), autolim=False)
    for label in drawn.labels:
        size = label.height / POINT / CAPITALS
        how = {"rotation": label.angle, "rotation_mode": "anchor", "ha": "center", "va": "center_baseline"}
        axes.text(*label.place, label.text.replace("$", r"\$"), fontsize=size, color=_rgb(LAYERS[label.layer].colour), **how)
    return figure


def _rgb(colour: tuple[int, int, int]) -> tuple[float, ...]:
    return tuple(part / 255 for part in colour)
