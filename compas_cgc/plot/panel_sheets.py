"""Drawings of panels as a PDF: the schedule, then one page per panel."""

from __future__ import annotations

import os
import textwrap
from collections.abc import Iterator
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Any
from typing import Union

import numpy as np

from .._figures import matplotlib_module
from .._figures import new_figure
from .._figures import save_pages
from ..fabrication.panel_schedule import PanelSheet
from .colours import INK

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["panel_figure", "save_panel_sheets"]

PAGE = (11.7, 8.3)  # A4 [in]
WARNING = "#b00020"
ROWS = 32  # of the schedule on one page
KEY = (0.81, 0.79, 0.16, 0.16)  # place of the small plan on the page of a panel
TEXT_WIDTH = 0.75  # width of a letter relative to its size, with room beside it
MARGIN = 0.16  # around an outline, relative to its size
MAX_LINE = 150  # characters of a remark on one line
HEAD = (
    "panel",
    "region",
    "mould",
    "K [1/m²]",
    "length x width [mm]",
    "rise [mm]",
    "area [m²]",
    "stress",
    "sides [mm] and neighbours",
)


def save_panel_sheets(sheets: list[PanelSheet], path: Union[str, os.PathLike], title: str = "") -> Path:
    """Write the schedule of panels and one drawing per panel as PDF; panels that would break are red.

    Raises
    ------
    CGCError
        If matplotlib is not installed.
    FileError
        If the file cannot be written.
    """
    matplotlib_module("figure")
    return save_pages(_pages(sheets, title), path)


def _pages(sheets: list[PanelSheet], title: str) -> Iterator[Figure]:
    for first in range(0, len(sheets), ROWS):
        yield _schedule(sheets[first : first + ROWS], f"{title} panels {first + 1} to {min(first + ROWS, len(sheets))} of {len(sheets)}")
    yield _plan(sheets, f"{title} plan of {len(sheets)} panels")
    for own in sheets:
        yield panel_figure(own, title, sheets)


def _schedule(sheets: list[PanelSheet], title: str) -> Figure:
    figure = new_figure(*PAGE)
    figure.text(0.05, 0.95, title.strip(), fontsize=11, color=INK)
    about = (
        "lengths in millimetres; sides counterclockwise from corner 1, seen from outside; rise: from the lowest to the highest point over "
        "the mean plane; stress: of bending on 95 % of the area, in % of the strength"
    )
    broken = [own.fit.panel.name for own in sheets if own.used > 1.0]
    figure.text(0.05, 0.935, f"{about} (red: the panel breaks)" if broken else about, fontsize=7, color=INK)
    columns = np.array([0.05, 0.11, 0.15, 0.19, 0.25, 0.35, 0.47, 0.52, 0.57])
    for row, (own, cells) in enumerate(zip([None, *sheets], [HEAD, *map(_cells, sheets)])):
        ink = WARNING if own is not None and own.used > 1.0 else INK
        for x, cell in zip(columns, cells):
            figure.text(x, 0.9 - row * 0.026, cell, fontsize=6.5, color=ink, weight="bold" if row == 0 else "normal")
    return figure


def _plan(sheets: list[PanelSheet], title: str) -> Figure:
    """Return the plan with the names of all panels, each with a dot at corner 1."""
    figure = new_figure(*PAGE)
    figure.text(0.05, 0.95, title.strip(), fontsize=11, color=INK)
    figure.text(0.05, 0.93, "seen from above, x to the right and y up, not to scale; dots: corner 1 of the panels", fontsize=7, color=INK)
    axes = _plan_axes(figure, sheets, (0.04, 0.04, 0.92, 0.86), "0.2")
    scale = 72.0 * min(0.92 * PAGE[0] / np.ptp(axes.get_xlim()), 0.86 * PAGE[1] / np.ptp(axes.get_ylim()))
    for own in sheets:
        plan = own.corners[:, :2]
        middle, name = plan.mean(axis=0), own.fit.panel.name
        room = scale * own.size[1] / (TEXT_WIDTH * len(name))
        axes.text(*middle, name, fontsize=min(8.0, room), color=INK, ha="center", va="center")
        axes.plot(*(plan[0] + 0.14 * (middle - plan[0])), marker="o", markersize=1.5, color=INK)
    return figure


def _plan_axes(figure: Figure, sheets: Sequence[PanelSheet], place: tuple[float, float, float, float], color: str) -> Any:
    """Draw the outlines of all panels from above into a part of a figure, x to the right, and return its axes."""
    axes: Any = figure.add_axes(place)
    axes.set_aspect("equal")
    axes.axis("off")
    # One line with gaps is drawn much faster than many polygons.
    paths = [np.vstack([own.corners[:, :2], own.corners[:1, :2], np.full((1, 2), np.nan)]) for own in sheets]
    axes.plot(*np.concatenate(paths).T, color=color, linewidth=0.4)
    return axes


def _cells(own: PanelSheet) -> tuple[str, ...]:
    sides = ", ".join(f"{side.length:.1f} ({side.neighbour})" for side in own.sides)
    size = f"{own.size[0]:.1f} x {own.size[1]:.1f}"
    about = (
        own.fit.panel.name,
        str(own.fit.panel.region),
        str(own.fit.mould),
        f"{own.K:.6g}",
        size,
        f"{own.rise:.1f}",
        f"{own.area:.3f}",
        f"{100.0 * own.used:.0f} %",
    )
    return (*about, sides if len(sides) < 90 else f"{len(own.sides)} sides, see the drawing")


def panel_figure(own: PanelSheet, title: str = "", sheets: Sequence[PanelSheet] = ()) -> Figure:
    """Return the drawing of a panel: outline with lengths, diagonals and neighbours, size, mould and K, and its place among others."""
    figure = new_figure(*PAGE)
    axes: Any = figure.add_axes((0.04, 0.2, 0.92, 0.58) if sheets else (0.04, 0.2, 0.92, 0.7))
    axes.set_aspect("equal")
    axes.axis("off")
    outline = np.vstack([side.points[:-1] for side in own.sides])
    low, high = outline.min(axis=0), outline.max(axis=0)
    middle, size = 0.5 * (low + high), float(np.ptp(outline, axis=0).max())
    axes.fill(*outline.T, facecolor="0.96", edgecolor=INK, linewidth=1.0)
    corners = np.array([side.points[0] for side in own.sides])
    for i, j, length in own.diagonals if len(own.sides) <= 6 else ():
        axes.plot(*corners[[i, j]].T, color="0.6", linewidth=0.5, linestyle=(0, (6, 3)))
        # Beside the middle, where diagonals cross.
        place = corners[i] + 0.36 * (corners[j] - corners[i])
        axes.text(*place, f"{length:.1f}", fontsize=7, color="0.35", ha="center", va="center", rotation=_upright(corners[j] - corners[i]))
    for k, side in enumerate(own.sides):
        chord = side.points[-1] - side.points[0]
        out = np.array([chord[1], -chord[0]]) / max(float(np.linalg.norm(chord)), 1e-9)
        at = side.points[len(side.points) // 2] if len(side.points) > 2 else side.points.mean(axis=0)
        angle = _upright(chord)
        axes.text(*(at - 0.03 * size * out), f"{side.length:.1f}", fontsize=8, color=INK, ha="center", va="center", rotation=angle)
        axes.text(*(at + 0.035 * size * out), side.neighbour, fontsize=8, color="0.4", ha="center", va="center", rotation=angle)
        axes.plot(*corners[k], marker="o", markersize=3, color=INK)
        away = corners[k] - middle
        number = f"{k + 1} ({own.heights[k]:+.1f})"
        axes.text(*(corners[k] + 0.045 * size * away / np.linalg.norm(away)), number, fontsize=7, color=INK, ha="center", va="center")
    if sheets:
        plan = _plan_axes(figure, sheets, KEY, "0.7")
        plan.fill(*own.corners[:, :2].T, facecolor="0.4", edgecolor=INK, linewidth=0.4)
        plan.plot(*own.corners[0, :2], marker="o", markersize=2.5, color=INK)
        figure.text(KEY[0] + 0.5 * KEY[2], KEY[1] - 0.015, "place in plan, from above; dot: corner 1", fontsize=6, color=INK, ha="center")
    axes.set_xlim(low[0] - MARGIN * size, high[0] + MARGIN * size)
    axes.set_ylim(low[1] - MARGIN * size, high[1] + MARGIN * size)
    figure.text(0.05, 0.95, f"{title} panel {own.fit.panel.name}".strip(), fontsize=13, color=INK, weight="bold")
    about = "seen from outside in its mean plane, not to scale, lengths in millimetres; no joint is taken off"
    figure.text(0.05, 0.925, about, fontsize=7, color=INK)
    shape = f"K = {own.K:.6g} 1/m², radius {own.radius:.1f} mm" if own.radius else "plane"
    lines = [
        f"region {own.fit.panel.region}, mould {own.fit.mould}: {shape}",
        f"rectangle {own.size[0]:.1f} x {own.size[1]:.1f} mm, rise over the mean plane {own.rise:.1f} mm, area {own.area:.3f} m²",
        "inside: lengths of sides along the panel; outside: panels beyond; dashed: straight distances between corners; "
        "at corners: number (height over the mean plane, + to the viewer)",
    ]
    if own.fit.stress is not None:
        breaks = ": the panel breaks" if own.used > 1.0 else ""
        lines.insert(
            2,
            f"bending stress from the mould into position: {own.fit.stress:.1f} MPa at most; on 95 % of the area "
            f"{own.fit.stress_95:.1f} MPa, {100.0 * own.used:.0f} % of the strength of the material{breaks}",
        )
    lines += [row for remark in own.remarks for row in textwrap.wrap(remark, MAX_LINE)]
    figure.text(0.05, 0.04, "\n".join(lines), fontsize=8, color=WARNING if own.used > 1.0 else INK, linespacing=1.6)
    return figure


def _upright(direction: np.ndarray) -> float:
    """Return the rotation of a text along a direction that is readable from below or from the right [degrees]."""
    angle = float(np.degrees(np.arctan2(direction[1], direction[0])))
    return angle - 180.0 if angle > 90.0 else angle + 180.0 if angle <= -90.0 else angle
