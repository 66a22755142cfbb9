"""Arrangement of views on a sheet, with a title block."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np
from numpy.typing import ArrayLike

from ...discrete import face_areas
from ...discrete.arrays import FloatArray
from ...errors import CGCError
from ...errors import names_what_was_meant
from ...model.given import refuse_other_units
from ...model.problem import PosesProblem
from ...model.problem import problem_of
from .. import option_values as values
from ..drawing import Line
from ..figures import metres
from ..figures import unit_symbol
from ..option_values import PAPERS
from ..picture_key import curvature_text
from ..picture_key import scale_bar
from .level_lines import level_lines
from .marks import TEXT_HEIGHT
from .marks import Label
from .marks import View
from .marks import letters
from .notes import legend
from .projections import UPRIGHT_PADDING
from .projections import Cut
from .projections import Shape
from .projections import elevation
from .projections import plan
from .projections import section

__all__ = ["SHEETS", "ViewSheet", "draw_views"]

SHEETS: dict[str, tuple[float, float]] = dict(
    zip(PAPERS, ((297.0, 210.0), (420.0, 297.0), (594.0, 420.0), (841.0, 594.0), (1189.0, 841.0)))
)  # [mm]
DEFAULT_SHEET = "A3"
SCALES = (1, 2, 5, 10, 20, 25, 50, 100, 200, 250, 500, 1000, 2000, 2500, 5000, 10_000, 20_000, 50_000, 100_000)  # denominators
BAR_ROOM = 36.0  # for the scale bar and its length in the title block [mm]
MARGIN = 10.0  # of the frame [mm]
STRIP = 16.0  # height of the title block [mm]
CONTOURS = 10  # approximate number of contour lines
MAX_CONTOURS = 500


class _Groups(NamedTuple):
    """Rows or columns of views."""

    axis: int  # 0 for rows, 1 for columns
    views: list[list[int]]  # numbers of the views of each


class ViewSheet(NamedTuple):
    """Plan, sections and elevations on a sheet.

    Parameters
    ----------
    lines
        Lines by layer, in millimetres of the sheet.
    labels
        Texts by layer, in millimetres of the sheet.
    sheet
        Size of the sheet, such as ``A3``.
    scale
        Denominator of the scale.
    units
        Units of the surface and of the heights, such as ``Meters``.
    interval
        Height between contour lines [L].
    views
        Names of the views.
    contours
        Heights and polylines ``(k, 3)`` of the contour lines [L].
    cuts
        Letters and polylines ``(k, 3)`` of the sections [L].

    Examples
    --------
    >>> from compas_cgc import CGCMesh
    >>> from compas_cgc.fabrication import draw_views
    >>> draw_views(CGCMesh.from_meshgrid(dx=4, nx=4)).size
    (420.0, 297.0)
    """

    lines: list[Line]
    labels: list[Label]
    sheet: str
    scale: int
    units: str
    interval: float
    views: tuple[str, ...]
    contours: list[tuple[float, FloatArray]]
    cuts: list[tuple[str, FloatArray]]

    @property
    def size(self) -> tuple[float, float]:
        """Width and height of the sheet [mm]."""
        return SHEETS[self.sheet]

    def summary(self) -> str:
        """Return one sentence."""
        names = ", ".join(own[0].lower() + own[1:] for own in self.views)
        unit = unit_symbol(self.units)
        return f"{len(self.views)} views at 1:{self.scale} on {self.sheet}: {names}; contour lines every {self.interval:g} {unit}"

    def __str__(self) -> str:
        return self.summary()


@names_what_was_meant()
def draw_views(
    surface: PosesProblem,
    scale: Optional[int] = None,
    sheet: Optional[str] = None,
    contours: Optional[float] = None,
    sections: Optional[Sequence[ArrayLike]] = None,
    north: Optional[ArrayLike] = None,
    title: Optional[str] = None,
) -> ViewSheet:
    """Draw the plan, sections and elevations of a surface to scale on one sheet.

    The plan shows outlines, creases, regions with their K, contour lines, supports with their heights, and dimensions. Sections show the
    cut and what is visible beyond; elevations show the visible outlines, creases and silhouettes from the south, east, north and west.

    Parameters
    ----------
    surface
        A result, mesh or problem.
    scale
        Denominator, such as 100 for 1:100. Default: the largest standard scale that fits on the sheet.
    sheet
        One of :data:`SHEETS`, in landscape. Default: A3, or the smallest for a given scale.
    contours
        Height between contour lines [L]. Default: about ten lines.
    sections
        Lines in plan ``(x, y, x, y)`` [L], each extended across the surface; the viewer looks to the left of its direction.
        Default: two lines through the middle, along x and y.
    north
        Direction of north in plan. Default: that of the drawing, or y.
    title
        Title of the drawing. Default: the name of the surface.

    Returns
    -------
    ViewSheet

    Raises
    ------
    CGCError
        If the surface has no faces, a line has no length, or the views do not fit on the sheet.

    Examples
    --------
    >>> import compas_cgc
    >>> print(draw_views(compas_cgc.get_problem("vault"), sections=[(0, 2, 1, 2)]))  # doctest: +SKIP
    6 views at 1:100 on A3: plan, section A-A, south elevation, east elevation, north elevation, west elevation; contour lines every 0.5 m
    """
    problem = problem_of(surface, "or the result of a solve is drawn").without_dummies()
    if not len(problem.faces):
        raise CGCError("the mesh has no faces; give a mesh with faces")
    shape = Shape(problem)
    scale = None if scale is None else values.whole(scale, "scale")
    sheet = None if sheet is None else values.text(sheet, "sheet")
    title = problem.drawing.name if title is None else values.text(title, "title")
    interval = _interval(shape, None if contours is None else values.number(contours, "contours"))
    upwards = _direction(
        np.array(problem.drawing.north if north is None else values.plan_vector(_plain(north), "north")), "the direction of north"
    )
    cuts = _cuts(shape, None if sections is None else values.plan_lines(_plain(sections), "sections"))
    units = problem.drawing.units or "Meters"
    unit_mm = 1000.0 * metres(units)
    sizes = _sizes(shape, cuts, upwards)
    paddings = np.array([shape.plan_padding.sum(axis=0), *[UPRIGHT_PADDING.sum(axis=0)] * (len(sizes) - 1)])
    name, found, groups = _chosen(sizes, paddings, unit_mm, scale, sheet)
    k = unit_mm / found
    sides = {"South": -upwards, "East": _east(upwards), "North": upwards, "West": -_east(upwards)}
    views = [plan(shape, k, interval, cuts, upwards), *(section(shape, k, cut) for cut in cuts)]
    views += [elevation(shape, k, side, towards) for side, towards in sides.items()]
    placed = _placed(views, groups, SHEETS[name])
    frame_lines, frame_labels = _title_block(shape, SHEETS[name], title, found, name, units, interval)
    levels = [
        (level, line) for level in shape.levels(interval) for line in level_lines(shape.vertices, shape.faces, shape.vertices[:, 2], level)
    ]
    lines_of = {cut.letter: _cut_lines(shape, cut) for cut in cuts}
    return ViewSheet(
        [*frame_lines, *(line for view in placed for line in view.lines)],
        [*frame_labels, *(label for view in placed for label in view.labels)],
        name,
        found,
        units,
        interval,
        tuple(view.name for view in views),
        levels,
        [(letter, line) for letter, lines in lines_of.items() for line in lines],
    )


def _plain(given: Any) -> Any:
    """Return arrays, also within a list, as lists."""
    if isinstance(given, (list, tuple)):
        return [_plain(own) for own in given]
    return given.tolist() if isinstance(given, np.ndarray) else given


def _cut_lines(shape: Shape, cut: Cut) -> list[FloatArray]:
    left = np.array([-cut.along[1], cut.along[0]])
    return level_lines(shape.vertices, shape.faces, (shape.vertices[:, :2] - cut.start) @ left, 0.0)


def _direction(vector: FloatArray, what: str) -> FloatArray:
    length = float(np.linalg.norm(vector))
    if not length > 0.0:
        raise CGCError(f"{what} must be two numbers that are not both zero, such as 0,1")
    return vector / length


def _east(north: FloatArray) -> FloatArray:
    return np.array([north[1], -north[0]])


def _interval(shape: Shape, given: Optional[float]) -> float:
    """Return the height between contour lines: the given one, or 1, 2 or 5 times a power of ten."""
    rise = float(shape.high[2] - shape.low[2])
    if given is None:
        least = max(rise, 1e-3 * float(np.ptp(np.stack([shape.low, shape.high]), axis=0).max())) / CONTOURS
        power = 10.0 ** np.floor(np.log10(least))
        return float(next(step * power for step in (1.0, 2.0, 5.0, 10.0) if step * power >= least * (1 - 1e-9)))
    if not given > 0.0:
        raise CGCError("the height between contour lines must be positive")
    size = float(np.linalg.norm(shape.high - shape.low))
    refuse_other_units("the height between contour lines", given, size, shape.problem.drawing.units)
    if rise / given > MAX_CONTOURS:
        raise CGCError(f"contour lines every {given:g} would be {rise / given:.0f} lines; use {rise / 100:.2g} or more")
    return float(given)


def _cuts(shape: Shape, sections: Optional[Sequence[Sequence[float]]]) -> list[Cut]:
    given = [_through_middle(shape, way) for way in np.eye(2)] if sections is None else [np.asarray(own, float) for own in sections]
    if len(given) > 26:
        raise CGCError(f"a sheet holds at most 26 sections, not {len(given)}")
    cuts = []
    for number, line in enumerate(given):
        along = _direction(line[2:] - line[:2], f"the line of section {chr(65 + number)} from its first to its second point")
        cut = Cut(chr(65 + number), line[:2], along)
        if not _cut_lines(shape, cut):
            raise CGCError(f"the line of section {cut.letter} does not cross the surface; give points in plan within its outline")
        cuts.append(cut)
    return cuts


def _through_middle(shape: Shape, along: FloatArray) -> FloatArray:
    """Return a line (4,) in plan through the middle of a surface; where this lies between parts or in a court, through its median."""
    middle = 0.5 * (shape.low + shape.high)[:2]
    if not _cut_lines(shape, Cut("", middle, along)):
        centres = shape.vertices[shape.faces].mean(axis=1)
        order = np.argsort(centres[:, :2] @ [-along[1], along[0]], kind="stable")
        sums = face_areas(shape.vertices, shape.faces)[order].cumsum()
        middle = centres[order[np.searchsorted(sums, 0.5 * sums[-1])], :2]
    return np.concatenate([middle, middle + along])


def _sizes(shape: Shape, cuts: Sequence[Cut], north: FloatArray) -> FloatArray:
    """Return the widths and heights of all views without their annotations [L], in the order of the sheet, the plan first."""
    used = shape.vertices[np.unique(shape.faces)]
    height = float(shape.high[2] - shape.low[2])
    ways = [*(cut.along for cut in cuts), *(np.array([_east(north), north, _east(north), north]))]
    return np.array([(shape.high - shape.low)[:2], *((np.ptp(used[:, :2] @ way), height) for way in ways)])


def _chosen(
    sizes: FloatArray, paddings: FloatArray, unit_mm: float, scale: Optional[int], sheet: Optional[str]
) -> tuple[str, int, _Groups]:
    """Return the sheet, the scale, and the rows or columns of views, for sizes (k, 2) [L] with room around them (k, 2) [mm]."""
    if sheet is not None and sheet not in SHEETS:
        raise CGCError(f"the sheet must be one of {', '.join(SHEETS)}, not {sheet!r:.20}")
    if scale is not None and not scale > 0:
        raise CGCError("the scale must be a positive denominator, such as 100 for 1:100")
    names = [sheet] if sheet else list(SHEETS) if scale else [DEFAULT_SHEET]
    for name in names:
        for found in SCALES if scale is None else (scale,):
            groups = _grouped(unit_mm / found * sizes + paddings, SHEETS[name])
            if groups is not None:
                return name, found, groups
    if scale is None:
        raise CGCError(f"the {len(sizes)} views do not fit on {names[0]} at any scale; use a larger sheet, or draw fewer sections")
    fits = next((own for own in SCALES if _grouped(unit_mm / own * sizes + paddings, SHEETS[names[-1]]) is not None), None)
    remedy = "draw fewer sections" if fits is None else f"use 1:{fits}"
    raise CGCError(f"at 1:{scale} the views do not fit on {names[-1]}; {remedy}{'' if sheet is None else ', or a larger sheet'}")


def _room(sheet: tuple[float, float]) -> FloatArray:
    """Return the width and height that views may fill (2,) [mm]."""
    return np.array(sheet) - 2 * MARGIN - [0.0, STRIP]


def _grouped(sizes: FloatArray, sheet: tuple[float, float]) -> Optional[_Groups]:
    """Return the rows of views from the top, else columns from the left, None if neither fits on a sheet."""
    room = _room(sheet)
    for axis in (0, 1):
        groups = _filled(sizes[:, axis], float(room[axis]))
        if groups is not None and sum(sizes[group, 1 - axis].max() for group in groups) <= room[1 - axis]:
            return _Groups(axis, groups)
    return None


def _filled(lengths: FloatArray, room: float) -> Optional[list[list[int]]]:
    """Return the views of each row or column in order, for their lengths (k,) along it, None if one is longer than the room [mm]."""
    groups: list[list[int]] = []
    for number, own in enumerate(lengths):
        if own > room:
            return None
        if groups and lengths[groups[-1]].sum() + own <= room:
            groups[-1].append(number)
        else:
            groups.append([number])
    return groups


def _placed(views: Sequence[View], groups: _Groups, sheet: tuple[float, float]) -> list[View]:
    """Return the views in their places, with equal gaps; those of a row have a common lower edge, those of a column a common middle."""
    sizes, room = np.array([view.size for view in views]), _room(sheet)
    axis, other = groups.axis, 1 - groups.axis
    widths = [float(sizes[group, other].max()) for group in groups.views]
    gap = (room[other] - sum(widths)) / (len(widths) + 1)
    start, placed = gap, list[View]()
    for group, width in zip(groups.views, widths):
        space = (room[axis] - sizes[group, axis].sum()) / (len(group) + 1)
        at = space
        for k in group:
            corner = np.zeros(2)  # upper left corner, from that of the room to the right and down
            corner[axis] = at
            corner[other] = start + (width - sizes[k, other]) * (1.0 if axis == 0 else 0.5)
            placed.append(views[k].moved(np.array([MARGIN + corner[0], sheet[1] - MARGIN - corner[1] - sizes[k, 1]])))
            at += sizes[k, axis] + space
        start += width + gap
    return placed


def _title_block(
    shape: Shape, size: tuple[float, float], title: str, scale: int, sheet: str, units: str, interval: float
) -> tuple[list[Line], list[Label]]:
    """Return the frame of the sheet and its title block, with the legend in its first cell."""
    problem = shape.problem
    low, high = np.array([MARGIN, MARGIN]), np.array(size) - MARGIN
    corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
    unit = unit_symbol(units)
    known = "" if problem.drawing.units else " (assumed)"
    cells = [
        ("", ""),
        ("Title", title),
        ("Scale", f"1:{scale} ({sheet})"),
        ("Lengths and heights", f"{unit}{known}"),
        ("Contour lines", f"every {interval:g} {unit}"),
        ("Gaussian curvature", curvature_text(problem) or "-"),
    ]
    needed = np.array([max(letters(head, 0.8 * TEXT_HEIGHT), letters(text, 1.2 * TEXT_HEIGHT)) + 4.0 for head, text in cells])
    width = high[0] - low[0]
    needed[1] = min(needed[1], 0.25 * width)
    needed[2] += BAR_ROOM
    needed[0] = max(width - needed[1:].sum(), 0.25 * width)
    edges = low[0] + np.concatenate([[0.0], np.cumsum(needed)]) * min(1.0, width / needed.sum())
    top = low[1] + STRIP
    lines = [Line("FRAME", corners, closed=True), Line("FRAME", np.array([[low[0], top], [high[0], top]]))]
    lines += [Line("FRAME", np.array([[x, low[1]], [x, top]])) for x in edges[1:-1]]
    labels = []
    for (head, text), left, right in zip(cells, edges, edges[1:]):
        height = min(1.2 * TEXT_HEIGHT, 1.2 * TEXT_HEIGHT * (right - left - 3.0) / max(letters(text, 1.2 * TEXT_HEIGHT), 1e-9))
        middle = 0.5 * (left + right - (BAR_ROOM if head == "Scale" else 0.0))
        labels.append(Label("TEXT", head, np.array([middle, top - 4.0]), 0.8 * TEXT_HEIGHT))
        labels.append(Label("TEXT", text, np.array([middle, low[1] + 5.0]), height))
    small = 0.8 * TEXT_HEIGHT
    bar = scale_bar(unit, 0.5 * BAR_ROOM * scale / (1000.0 * metres(units)), 1000.0 * metres(units) / scale, small)
    bar = bar.moved(np.array([edges[3] - BAR_ROOM, low[1] + 5.0]))
    lines += [Line("FRAME", line) for line in bar.lines]
    labels += [Label("TEXT", text, place + [0.5 * letters(text, small), 0.0], small) for text, place in bar.texts]
    cell = legend(shape, unit, (edges[1] - edges[0] - 3.0, STRIP - 1.0))
    return lines, [*labels[2:], *(own._replace(place=own.place + [low[0] + 1.5, low[1] + 0.5]) for own in cell)]
