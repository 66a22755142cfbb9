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
from ..discrete.arrays import FloatArray
from ..fabrication.front_view import seen_from
from ..fabrication.front_view import view_name
from ..fabrication.mould_layout import shapes_note
from ..fabrication.panel_schedule import FLAT_TRIANGLES
from ..fabrication.panel_schedule import MEAN_PLANE
from ..fabrication.panel_schedule import PanelSheet
from ..fabrication.panel_schedule import model_notes
from ..fabrication.panel_schedule import panel_totals
from ..fabrication.picture_key import K_MEANING
from ..fabrication.picture_key import Key
from ..meshing.polyline import arc_lengths
from ..meshing.polyline import point_at
from ..model.problem import Drawing
from .colours import INK
from .free_texts import LETTER
from .free_texts import FreeTexts
from .layout import points_per_length
from .legend import add_key

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["panel_figure", "save_panel_sheets"]

Plan = tuple[float, float]

NORTH = Drawing().north
PAGE = (11.7, 8.3)  # A4 [in]
WARNING = "#b00020"
ROWS = 32  # of the schedule on one page
HEAD_TOP, HEAD_PITCH, FOOT = 0.938, 0.015, 0.05  # of the text above the schedule and of its last row, relative to the page
KEY = (0.81, 0.79, 0.16, 0.16)  # place of the small plan on the page of a panel
TEXT_WIDTH = 0.75  # width of a letter relative to its size, with room beside it
SHARES = (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8)  # of a side at which its texts are tried
DIAGONAL_SHARES = (0.36, 0.28, 0.44, 0.2, 0.64, 0.72, 0.8)  # beside the middle, where diagonals cross
MARGIN = 0.16  # around an outline, relative to its size
MAX_NOTE = 215  # characters of the notes of the schedule on one line
MAX_ABOUT = 165  # characters of the notes on the page of a panel on one line, beside the small plan
MAX_LINE = 180  # characters of a remark on one line
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


def save_panel_sheets(sheets: list[PanelSheet], path: Union[str, os.PathLike], title: str = "", north: Plan = NORTH) -> Path:
    """Write the schedule of panels and one drawing per panel as PDF, with a direction of north in plan; panels that would break are red.

    Raises
    ------
    CGCError
        If matplotlib is not installed.
    FileError
        If the file cannot be written.
    """
    matplotlib_module("figure")
    return save_pages(_pages(sheets, title, north), path)


def _pages(sheets: list[PanelSheet], title: str, north: Plan) -> Iterator[Figure]:
    for first in range(0, len(sheets), ROWS):
        page = sheets[first : first + ROWS]
        yield _schedule(page, f"{title} panels {first + 1} to {first + len(page)} of {len(sheets)}", panel_totals(sheets))
    views = _by_view(sheets)
    names = [view_name(same[0].view, north) for same in views]
    for same, name in zip(views, names):
        others = ", ".join(other for other in names if other != name)
        count = f"{len(same)} of {len(sheets)} panels" if others else f"{len(same)} panels"
        yield _plan(same, f"{title} {name} of {count}", f"; the other panels are in: {others}" if others else "", north)
    for own in sheets:
        yield panel_figure(own, title, sheets, north)


def _by_view(sheets: Sequence[PanelSheet]) -> list[list[PanelSheet]]:
    """Return the panels of the plan and of every elevation, those of the view with most panels first."""
    found: list[list[PanelSheet]] = []
    for own in sheets:
        same = next((group for group in found if np.array_equal(group[0].view, own.view)), None)
        found.append([own]) if same is None else same.append(own)
    return sorted(found, key=len, reverse=True)


def _schedule(sheets: list[PanelSheet], title: str, totals: str) -> Figure:
    figure = new_figure(*PAGE)
    figure.text(0.05, 0.95, title.strip(), fontsize=11, color=INK)
    broken = [own.fit.panel.name for own in sheets if own.used > 1.0]
    about = (
        f"lengths in millimetres; length x width: rectangle around the bent panel, not its blank; sides: counterclockwise from corner 1, "
        f"{_seen(sheets)}; rise: from the lowest to the highest point over the mean plane; stress: of bending on 95 % of the area, in % of "
        f"the characteristic strength of {sheets[0].strength:g} MPa{' (red: the panel breaks)' if broken else ''}; {K_MEANING}"
    )
    notes = (totals, about, MEAN_PLANE, FLAT_TRIANGLES, *model_notes(sheets))
    lines = [line for note in notes for line in textwrap.wrap(note, MAX_NOTE)]
    figure.text(0.05, HEAD_TOP, "\n".join(lines), fontsize=7, color=INK, va="top")
    top = HEAD_TOP - HEAD_PITCH * (len(lines) + 1)
    pitch = (top - FOOT) / ROWS
    columns = np.array([0.05, 0.11, 0.15, 0.19, 0.25, 0.35, 0.47, 0.52, 0.57])
    for row, (own, cells) in enumerate(zip([None, *sheets], [HEAD, *map(_cells, sheets)])):
        ink = WARNING if own is not None and own.used > 1.0 else INK
        for x, cell in zip(columns, cells):
            figure.text(x, top - row * pitch, cell, fontsize=6.5, color=ink, weight="bold" if row == 0 else "normal")
    return figure


def _plan(sheets: list[PanelSheet], title: str, others: str, north: Plan) -> Figure:
    """Return the plan with the names of panels, each with a dot at corner 1, and a remark on where others are."""
    figure = new_figure(*PAGE)
    figure.text(0.05, 0.95, title.strip(), fontsize=11, color=INK)
    figure.text(0.05, 0.93, f"{seen_from(sheets[0].view)}; dots: corner 1 of the panels{others}", fontsize=7, color=INK)
    axes = _plan_axes(figure, sheets, (0.04, 0.08, 0.92, 0.82), "0.2")
    add_key(axes, Key("mm", north, _curvatures(sheets)), sheets[0].view)
    scale = points_per_length(axes)
    for own in sheets:
        plan = _flat(own)
        middle, name = plan.mean(axis=0), own.fit.panel.name
        room = scale * own.size[1] / (TEXT_WIDTH * len(name))
        axes.text(*middle, name, fontsize=min(8.0, room), color=INK, ha="center", va="center")
        axes.plot(*(plan[0] + 0.14 * (middle - plan[0])), marker="o", markersize=1.5, color=INK)
    return figure


def _plan_axes(figure: Figure, sheets: Sequence[PanelSheet], place: tuple[float, float, float, float], color: str) -> Any:
    """Draw the outlines of all panels in their plan or elevation into a part of a figure, and return its axes."""
    axes: Any = figure.add_axes(place)
    axes.set_aspect("equal")
    axes.axis("off")
    # One line with gaps is drawn much faster than many polygons.
    paths = [np.vstack([_flat(own), _flat(own)[:1], np.full((1, 2), np.nan)]) for own in sheets]
    axes.plot(*np.concatenate(paths).T, color=color, linewidth=0.4)
    return axes


def _flat(own: PanelSheet) -> FloatArray:
    """Return the outline of a panel in the plan or elevation of the roof, from corner 1 (n, 2) [mm]."""
    return own.outline @ own.view[:2].T


def _curvatures(sheets: Sequence[PanelSheet]) -> tuple[str, ...]:
    """Return the range of the K of panels as words of a key."""
    low, high = (f"{end(own.K + 0.0 for own in sheets):.3g}" for end in (min, max))
    return (f"K = {low if low == high else f'{low} to {high}'} 1/m²",)


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


def _draw_outline(axes: Any, own: PanelSheet, outline: FloatArray, scale: float) -> None:
    """Draw the outline (k, 2) of a panel with its diagonals, lengths, neighbours and corners, at points of the page per millimetre."""
    texts = FreeTexts(axes, scale)
    texts.keep_free(outline, closed=True)
    middle, corners = outline.mean(axis=0), np.array([side.points[0] for side in own.sides])
    axes.fill(*outline.T, facecolor="0.96", edgecolor=INK, linewidth=1.0)
    axes.plot(*corners.T, marker="o", markersize=3, color=INK, linestyle="")
    steps = (10.0 + 4.0 * np.arange(40)) / scale
    for k, corner in enumerate(corners):
        away = (corner - middle) / np.linalg.norm(corner - middle)
        texts.put(f"{k + 1} ({own.heights[k]:+.1f})", [corner + step * np.array([1.6, 1.0]) * away for step in steps], 7)
    crowded = []
    for side in own.sides:
        chord = side.points[-1] - side.points[0]
        out = np.array([chord[1], -chord[0]]) / max(float(np.linalg.norm(chord)), 1e-9)
        words = f"{side.length:.1f}"
        if 1.2 * LETTER * 8.0 * max(len(words), len(side.neighbour)) > scale * float(np.linalg.norm(chord)):
            crowded.append((side, out))
            continue
        for text, aside, color in ((words, -8.0 * out / scale, INK), (side.neighbour, 8.0 * out / scale, "0.4")):
            texts.put(text, [_along(side.points, share) + aside for share in SHARES], 8, _upright(chord), color)
    # Beside sides that are shorter than their texts, these stand outside at the end of a line.
    for side, out in crowded:
        foot = _along(side.points, 0.5)
        end = texts.put(f"{side.length:.1f}, {side.neighbour}", [foot + 2.0 * step * out for step in steps], 8)
        axes.plot(*np.stack([foot, foot + 0.8 * (end - foot)]).T, color="0.6", linewidth=0.4)
    for i, j, length in own.diagonals if len(own.sides) <= 6 else ():
        ends = corners[[i, j]]
        axes.plot(*ends.T, color="0.6", linewidth=0.5, linestyle=(0, (6, 3)))
        texts.put(f"{length:.1f}", [_along(ends, share) for share in DIAGONAL_SHARES], 7, _upright(ends[1] - ends[0]), "0.35")


def _along(points: FloatArray, share: float) -> FloatArray:
    """Return the point of a polyline (k, 2) at a share of its length (2,)."""
    return point_at(points, share * arc_lengths(points)[-1:])[0]


def panel_figure(own: PanelSheet, title: str = "", sheets: Sequence[PanelSheet] = (), north: Plan = NORTH) -> Figure:
    """Return the drawing of a panel: outline with lengths, diagonals and neighbours, size, mould and K, and its place among others."""
    figure = new_figure(*PAGE)
    place = (0.04, 0.24, 0.92, 0.54) if sheets else (0.04, 0.24, 0.92, 0.66)
    axes: Any = figure.add_axes(place)
    axes.set_aspect("equal")
    axes.axis("off")
    outline = np.vstack([side.points[:-1] for side in own.sides])
    low, high = outline.min(axis=0), outline.max(axis=0)
    size = float(np.ptp(outline, axis=0).max())
    room = 72.0 * np.array(PAGE) * place[2:] / (high - low + 2.0 * MARGIN * size)
    _draw_outline(axes, own, outline, float(room.min()))
    if sheets:
        plan = _plan_axes(figure, [other for other in sheets if np.array_equal(other.view, own.view)], KEY, "0.7")
        plan.fill(*_flat(own).T, facecolor="0.4", edgecolor=INK, linewidth=0.4)
        plan.plot(*_flat(own)[0], marker="o", markersize=2.5, color=INK)
        add_key(plan, Key("mm", north), own.view, size=6.0)
        # Above the plan, because the arrow to north is below it.
        where = f"place in {view_name(own.view, north)}; dot: corner 1"
        figure.text(KEY[0] + 0.5 * KEY[2], KEY[1] + KEY[3] + 0.01, where, fontsize=6, color=INK, ha="center")
    axes.set_xlim(low[0] - MARGIN * size, high[0] + MARGIN * size)
    axes.set_ylim(low[1] - MARGIN * size, high[1] + MARGIN * size)
    add_key(axes, Key("mm", None), below=8.0)
    figure.text(0.05, 0.95, f"{title} panel {own.fit.panel.name}".strip(), fontsize=13, color=INK, weight="bold")
    about = (
        f"{_seen([own])}, in its mean plane, lengths in millimetres, at the middle of the thickness; panels meet edge to edge: "
        "no gap is left for joints"
    )
    notes = [line for note in (about, MEAN_PLANE, shapes_note(own.unit)) for line in textwrap.wrap(note, MAX_ABOUT)]
    figure.text(0.05, 0.935, "\n".join(notes), fontsize=7, color=INK, va="top", linespacing=1.4)
    lines = [
        f"region {own.fit.panel.region}; {own.mould}; {K_MEANING}",
        f"rectangle around the bent panel {own.size[0]:.1f} x {own.size[1]:.1f} mm, rise over the mean plane {own.rise:.1f} mm, "
        f"area {own.area:.3f} m²; edges of its flat triangles lie up to {own.fit.sag:.1f} mm from the smooth surface",
        "inside: lengths of sides along the panel; outside: panels beyond; dashed: straight distances between corners; "
        "at corners: number (height over the mean plane, + to the viewer)",
    ]
    if own.fit.stress is not None:
        breaks = ": the panel breaks" if own.used > 1.0 else ""
        lines.insert(
            2,
            f"bending stress from the mould into position: {own.fit.stress:.1f} MPa at most; on 95 % of the area "
            f"{own.fit.stress_95:.1f} MPa, {100.0 * own.used:.0f} % of the characteristic strength of {own.strength:g} MPa{breaks}",
        )
    lines = [row for line in [*lines, *own.remarks] for row in textwrap.wrap(line, MAX_LINE)]
    figure.text(0.05, 0.04, "\n".join(lines), fontsize=8, color=WARNING if own.used > 1.0 else INK, linespacing=1.6)
    return figure


def _seen(sheets: Sequence[PanelSheet]) -> str:
    """Return from where panels are seen, also above or below if it is one of them for all."""
    above = {own.above for own in sheets}
    return "seen from outside" + (f", here from {'above' if above.pop() else 'below'}" if len(above) == 1 else "")


def _upright(direction: np.ndarray) -> float:
    """Return the rotation of a text along a direction that is readable from below or from the right [degrees]."""
    angle = float(np.degrees(np.arctan2(direction[1], direction[0])))
    return angle - 180.0 if angle > 90.0 else angle + 180.0 if angle <= -90.0 else angle
