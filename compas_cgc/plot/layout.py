"""Panel layout: figures with panels at the same scale, sized by their content."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import Any

from .._figures import new_figure
from .colours import INK
from .view import Frame

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["SIZE", "caption", "heading", "letter", "panels", "points_per_length", "show", "shown", "write"]

GAP = 0.25  # between panels [in]
EDGE = 0.12  # around the sheet [in]
SIZE = 8.0  # font size of captions [pt]
MAX_ASPECT = 1.4  # largest ratio of height to width of a figure


def panels(
    rows: list[list[Frame]], width: float = 7.0, head: float = 0.0, foot: float = 0.3, side: float = 0.0
) -> tuple[Figure, list[list[Axes]]]:
    """Lay out frames in rows and columns, all at the same scale.

    Parameters
    ----------
    rows
        Frames by row.
    width
        Width of the figure [in]; reduced if the figure would become too tall.
    head, foot, side
        Space above, below, and to the right of every panel [in].

    Returns
    -------
    Figure, list of list of Axes
        Axes without decoration that show the frames, enlarged to their cells.
    """
    columns = max(len(row) for row in rows)
    wide = [max(row[j].width for row in rows if j < len(row)) for j in range(columns)]
    tall = [max(frame.height for frame in row) for row in rows]
    extra_x = 2 * EDGE + (columns - 1) * GAP + columns * side
    extra_y = 2 * EDGE + len(rows) * (head + foot)
    scale = min((width - extra_x) / sum(wide), (MAX_ASPECT * width - extra_y) / sum(tall))
    figure_width, figure_height = max(extra_x + scale * sum(wide), 2.5), extra_y + scale * sum(tall)
    figure = new_figure(figure_width, figure_height)
    start = EDGE + (figure_width - extra_x - scale * sum(wide)) / 2
    result = []
    y = figure_height - EDGE
    for row, height in zip(rows, tall):
        y -= head + scale * height
        x, axes = start, []
        for frame, span in zip(row, wide):
            box = (x / figure_width, y / figure_height, scale * span / figure_width, scale * height / figure_height)
            axes.append(figure.add_axes(box))
            show(axes[-1], frame.grown(span, height))
            x += scale * span + side + GAP
        result.append(axes)
        y -= foot
    return figure, result


def show(ax: Axes, frame: Frame) -> None:
    """Set the limits of axes to a frame, at equal scale."""
    ax.set_axis_off()
    ax.set_xlim(frame.left, frame.right)
    ax.set_ylim(frame.bottom, frame.top)
    ax.set_aspect("equal", adjustable="box", anchor="C")


def shown(ax: Axes) -> Frame:
    """Return the frame shown by axes."""
    return Frame(*ax.get_xlim(), *ax.get_ylim())


def letter(i: int) -> str:
    """Return ``(a)``, ``(b)``, ... for 0, 1, ..."""
    return f"({chr(97 + i)})" if i < 26 else f"({i + 1})"


def caption(ax: Axes, text: str, below: float = 4.0) -> None:
    """Write a caption a number of points below the centre of a panel."""
    write(ax, text, (0.5, 0.0), (0.0, -below), ha="center", va="top", fontsize=SIZE)


def heading(row: list[Axes], text: str) -> None:
    """Write a title above a row of panels, left-aligned."""
    write(row[0], text, (0.0, 1.0), (0.0, 5.0), ha="left", va="bottom", fontsize=SIZE + 1, fontweight="bold")


def write(ax: Axes, text: str, at: tuple[float, float], offset: tuple[float, float], **style: Any) -> None:
    """Write a text at a relative position in the axes, with an offset in points."""
    ax.annotate(text, at, xycoords="axes fraction", xytext=offset, textcoords="offset points", color=INK, annotation_clip=False, **style)


def points_per_length(ax: Axes) -> float:
    """Return the number of points on paper per unit of length."""
    box = ax.get_position()
    width, height = ax.figure.figure.get_size_inches()
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    return 72.0 * float(min(box.width * width / (right - left), box.height * height / (top - bottom)))
