"""Contact sheet: every variant of a study as a small picture, with its number and parameters."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import Any
from typing import Optional

import numpy as np

from .._figures import matplotlib_module
from .._figures import new_figure
from ..errors import names_what_was_meant
from ..fabrication.figures import unit_symbol
from ..fabrication.picture_key import key_of
from ..plot.legend import add_key
from ..plot.view import Frame
from ..plot.view import frame_of
from ..plot.view import project
from ..plot.view import view_axes
from .results import Results
from .results import refuse_no_results
from .thumbnails import VIEW
from .thumbnails import thumbnail

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["contact_sheet"]

WIDTH = 24.0  # width of the sheet [in]
ASPECT = 1.5  # approximate ratio of width to height of the sheet
MAX_PICTURES = 2000  # on one sheet
MAX_PIXELS = 320  # width of a picture [pixel]
MIN_COLUMNS = 4
HEAD = 0.7  # height of the head of the sheet [in]
SIZE = 10.0  # font size of the key [pt]
LETTERS = 3  # number of text lines below a picture
COLOURS = {"fair": (0.62, 0.76, 0.80), "rough": (0.93, 0.66, 0.47), "unfinished": (0.78, 0.78, 0.78)}


@names_what_was_meant()
def contact_sheet(results: Results, variants: Optional[Sequence[int]] = None, show: Optional[Sequence[str]] = None) -> Figure:
    """Return the pictures of variants in the same view and at the same scale: fair blue, rough orange, unfinished grey.

    Parameters
    ----------
    results
        Results of a study.
    variants
        Numbers of the variants. Default: all, or an even selection if there are too many.
    show
        Columns below the pictures. Default: the first two parameters.

    Returns
    -------
    matplotlib.figure.Figure
        For :func:`compas_cgc.plot.save`.

    Raises
    ------
    CGCError
        If matplotlib is not installed, or a column or variant does not exist.

    Examples
    --------
    >>> contact_sheet(results)  # doctest: +SKIP
    """
    refuse_no_results(results)
    chosen = _chosen(len(results)) if variants is None else list(variants)
    shown = list(show or results.plan.inputs[: LETTERS - 1])
    frame = _frame(results, chosen)
    aspect = frame.height / frame.width
    columns = max(MIN_COLUMNS, math.ceil(math.sqrt(ASPECT * (aspect + 0.25) * len(chosen))))
    cell = WIDTH / columns  # [in]
    points = min(9.0, 72 * cell / 13)  # font size
    step = cell * aspect + LETTERS * 1.25 * points / 72
    height = HEAD + step * math.ceil(len(chosen) / columns)
    figure = new_figure(WIDTH, height)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    width = min(MAX_PIXELS, int(cell * figure.dpi))
    pixels = width, max(1, int(width * aspect))
    faces, creases = results.drawing.faces, results.drawing.creases
    words = _words(results, shown)
    for place, variant in enumerate(chosen):
        x, y = cell * (place % columns), HEAD + step * (place // columns)
        vertices = np.array(results.surfaces[variant])
        if np.isfinite(vertices).all():
            picture = thumbnail(vertices, faces, COLOURS[_kind(results, variant)], pixels, frame, creases)
            axes.imshow(picture, extent=(x, x + cell, y + cell * aspect, y), aspect="auto")
        axes.text(x + cell / 2, y + cell * aspect, words[variant], fontsize=points, ha="center", va="top", linespacing=1.05)
    axes.set_xlim(0.0, WIDTH)
    axes.set_ylim(height, 0.0)
    _head(axes, results, chosen)
    key = key_of(results.drawing)
    if any(own.kind == "K" for own in results.plan.study.parameters):
        key = key._replace(words=(f"K [1/{unit_symbol(results.drawing.drawing.units)}²]",))
    down = 72.0 * (0.5 * HEAD - height)
    add_key(axes, key, view_axes(VIEW), down, 72.0 * cell / frame.width, SIZE, 0.4)
    return figure


def _chosen(count: int) -> list[int]:
    if count <= MAX_PICTURES:
        return list(range(count))
    return np.unique(np.linspace(0, count - 1, MAX_PICTURES).astype(int)).tolist()


def _frame(results: Results, chosen: Sequence[int]) -> Frame:
    """Return the frame that contains all projected surfaces."""
    corners = []
    for variant in chosen:
        vertices = np.array(results.surfaces[variant])
        if np.isfinite(vertices).all():
            seen = project(vertices, VIEW, vertices)[:, :2]
            corners += [seen.min(axis=0), seen.max(axis=0)]
    return frame_of(np.array(corners).reshape(-1, 2))


def _kind(results: Results, variant: int) -> str:
    row = dict(zip(results.columns, results.rows[variant]))
    if row["status"] != "converged":
        return "unfinished"
    return "fair" if row["verdict"] == "fair" else "rough"


def _words(results: Results, shown: Sequence[str]) -> list[str]:
    values = [results.column(name) for name in shown]
    status = results.column("status")
    lines = []
    for k in range(len(results)):
        own = [f"{name} {_short(column[k])}" for name, column in zip(shown, values)]
        how = [] if status[k] == "converged" else [str(status[k])]
        lines.append("\n".join([f"{k}", *how, *own][:LETTERS]))
    return lines


def _short(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else "-" if value is None else str(value)


def _head(axes: Any, results: Results, chosen: Sequence[int]) -> None:
    kinds = [_kind(results, variant) for variant in chosen]
    part = "" if len(chosen) == len(results) else f", {len(chosen)} of them"
    text = f"{results.folder.name}: {len(results)} variants{part}"
    axes.text(0.15, 0.35, text, fontsize=14, va="center")
    patch = matplotlib_module("patches").Rectangle
    x = WIDTH - 6.6
    for kind, colour in COLOURS.items():
        axes.add_patch(patch((x, 0.22), 0.3, 0.26, color=colour))
        axes.text(x + 0.4, 0.35, f"{kind} ({kinds.count(kind)})", fontsize=12, va="center")
        x += 2.2
