"""Convergence plots: (a) energy and (b) error norm over the steps."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import Optional

import numpy as np

from .._figures import matplotlib_module
from .._figures import new_figure
from ..discrete.arrays import FloatArray
from ..errors import names_what_was_meant
from ..model.result import History
from .colours import INK
from .layout import SIZE
from .layout import caption
from .layout import letter
from .legend import per_area

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_history", "history_figure"]

LINE = "#1f4e79"


@names_what_was_meant()
def draw_history(
    history: History,
    energy: str = "Energy functional",
    axes: Optional[tuple[Axes, Axes]] = None,
    *,
    unit: Optional[str] = None,
) -> tuple[Axes, Axes]:
    """Draw the energy, and the error norm κ on a logarithmic axis, over the steps.

    Values that are not finite, and κ = 0, are omitted.

    Parameters
    ----------
    history
        History of a solve.
    energy
        Label of the energy.
    axes
        Two axes to draw on. Default: those of a new figure.
    unit
        Unit of length for the labels, such as ``"m"``.

    Returns
    -------
    (Axes, Axes)
        Axes of the energy and of the error norm.

    Raises
    ------
    CGCError
        If matplotlib is not installed.

    References
    ----------
    Paper, Eq. 30, Figures 9, 13, 17, 21, 25, 29, 30.

    Examples
    --------
    >>> import compas_cgc
    >>> dome = compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm")))
    >>> len(draw_history(dome.history))
    2
    """
    left, right = axes or plain_axes()
    in_unit = f" [{unit}]" if unit else ""
    draw_line(left, history.energy, energy + in_unit)
    draw_line(right, np.where(history.error_norm > 0, history.error_norm, np.nan), rf"Error norm $\kappa${per_area(unit)}", log=True)
    return left, right


@names_what_was_meant()
def history_figure(history: History, title: Optional[str] = None, *, unit: Optional[str] = None) -> Figure:
    """Return a figure of an iteration history with captions, as in the paper.

    Parameters
    ----------
    history
        History of a solve.
    title
        Title of the figure.
    unit
        Unit of length for the labels, such as ``"m"``.

    Returns
    -------
    matplotlib.figure.Figure
        For :func:`save`.

    Raises
    ------
    CGCError
        If matplotlib is not installed.

    Examples
    --------
    >>> import compas_cgc
    >>> dome = compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm")))
    >>> len(history_figure(dome.history).axes)
    2
    """
    axes = plain_axes(title)
    draw_history(history, axes=axes, unit=unit)
    for i, (ax, text) in enumerate(zip(axes, ("energy functional", "error norm from the target value"))):
        caption(ax, f"{letter(i)} {text}", below=34)
    return axes[0].figure.figure


def plain_axes(title: Optional[str] = None) -> tuple[Axes, Axes]:
    """Return two axes side by side on a new figure."""
    height = 2.6 if title is None else 2.85
    figure = new_figure(7.0, height)
    if title:
        figure.text(0.5, 1.0 - 0.08 / height, title, ha="center", va="top", fontsize=SIZE + 1, fontweight="bold", color=INK)
    boxes = ((left, 0.68 / height, 0.375, 1.72 / height) for left in (0.1, 0.605))
    first, second = (figure.add_axes(box) for box in boxes)
    return first, second


def draw_line(ax: Axes, values: FloatArray, label: str, log: bool = False) -> None:
    """Draw one value per step, the first at step 1."""
    values = np.where(np.isfinite(values), values, np.nan)
    drawn = bool(np.isfinite(values).any())
    ax.plot(np.arange(1, len(values) + 1), values, color=LINE, lw=1.1, marker="." if len(values) < 12 else "", ms=4)
    if log and drawn:
        ax.set_yscale("log")
    if not drawn:
        ax.set_yticks([])
        ax.text(0.5, 0.5, "no steps were taken", ha="center", va="center", transform=ax.transAxes, fontsize=SIZE, color="#777777")
    ax.set_xlim(0, max(len(values), 1))
    ax.xaxis.set_major_locator(matplotlib_module("ticker").MaxNLocator(nbins=6, integer=True))
    ax.set_xlabel("Steps", fontsize=SIZE, labelpad=2, color=INK)
    ax.set_ylabel(label, fontsize=SIZE, labelpad=3, color=INK)
    ax.tick_params(which="both", labelsize=SIZE - 1, length=3, width=0.6, colors=INK)
    ax.tick_params(which="minor", length=1.5, width=0.4)
    ax.yaxis.get_offset_text().set_fontsize(SIZE - 1)
    ax.grid(True, color="#e3e3e3", lw=0.5)
    ax.set_axisbelow(True)
    for side, spine in ax.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_linewidth(0.6)
