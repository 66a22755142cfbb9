"""Lines of a grid over all regions, which continue across the creases between them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete import edge_faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import CGCError
from ..model.given import checked_number
from ..model.problem import CGCProblem
from .grids import curvature_coordinates
from .grids import plan_coordinates
from .grids import square_coordinates

__all__ = ["Division", "GridLines", "Widths", "checked_widths", "grid_lines"]

MAX_SHIFT = 0.15  # largest shift of a grid line onto mesh edges, relative to the width of a face
FOLLOW_RATIO = 0.1  # remaining cut into faces, relative to the unshifted line, up to which it counts as following edges
SHIFT_TOLERANCE = 1e-6  # relative tolerance of the shift
MIN_REST = 0.2  # width of a rest, relative to the last given width, below which it joins the strip before
SAMPLES = 400  # of a coordinate, at which lengths along the surface are compared
MAX_LINES = 1_000_000  # along one axis
SIDE_TOLERANCE = 1e-9  # distance from a side, relative to the region, up to which a vertex lies on it

Widths = Union[float, Sequence[float]]


class Division(NamedTuple):
    """How a grid divides regions; one of `size`, `number`, `columns` or `rows`, and `largest` is given."""

    size: Optional[float] = None  # approximate width of the cells [L]
    number: Optional[int] = None  # approximate number of cells per region
    columns: Optional[Widths] = None  # widths along the first direction, the last one repeated [L]
    rows: Optional[Widths] = None  # widths along the second direction [L]
    largest: Optional[tuple[float, float]] = None  # lengths of the cells along the surface, at most about [L]
    along: str = "plan"  # "plan": along the sides of regions with four corners, else the axes of the plan; "curvature"


class Axis(NamedTuple):
    """Coordinate of a region that has the same lines as those of other regions."""

    region: int
    axis: int
    back: bool  # whether it runs the other way
    low: float  # range of the coordinate in the region, in the direction of the lines
    high: float


class GridLines(NamedTuple):
    """Coordinates of a grid at the corners of faces, and its lines."""

    values: FloatArray  # (m, 3, 2) coordinates from 0 to 1
    axes: list[list[Axis]]  # coordinates with the same lines
    lines: list[FloatArray]  # their positions, sorted

    @property
    def levels(self) -> list[list[FloatArray]]:
        """Sorted levels of the lines, by axis and region."""
        found: list[list[FloatArray]] = [[np.zeros(0)] * (1 + max(own.region for each in self.axes for own in each)) for _ in range(2)]
        for axes, lines in zip(self.axes, self.lines):
            for own in axes:
                inside = lines[(lines > own.low) & (lines < own.high)]
                found[own.axis][own.region] = np.sort(_turned(inside, own.back))
        return found

    @property
    def cells(self) -> FloatArray:
        """Number of cells of every region, with parts of cells (r,)."""
        found = np.ones(len(self.levels[0]))
        for axes, lines in zip(self.axes, self.lines):
            for own in axes:
                found[own.region] *= (own.high - own.low) * (len(lines) + 1)
        return np.maximum(found, 1.0)


class _Chart(NamedTuple):
    """Coordinates of one region."""

    vertices: IntArray  # (n,) its vertices
    faces: IntArray  # (f,) its faces
    corners: IntArray  # (f, 3) index of every corner in `vertices`
    at: FloatArray  # (n, 2) coordinates [L]
    square: bool  # whether they run along four sides

    def scaled(self, low: FloatArray, extent: FloatArray) -> FloatArray:
        """Return the coordinates relative to a rectangle at the corners of the faces (f, 3, 2)."""
        return ((self.at - low) / extent)[self.corners]


def grid_lines(problem: CGCProblem, region: IntArray, division: Division) -> GridLines:
    """Return the lines of a grid over all regions.

    Coordinates follow the sides of regions with four corners, and the axes of the plan elsewhere. Regions that share a whole side, and
    neighbours along the axes of the plan, have the same lines, so that joints continue across creases.

    Parameters
    ----------
    problem
        The surface.
    region
        (m,) region of every face, from 0.
    division
        Sizes or numbers of the cells.

    Raises
    ------
    CGCError
        If a region has fewer faces than cells, or a width is not positive.
    """
    charts = [_chart(problem, np.flatnonzero(region == k), division.along) for k in range(int(region.max(initial=-1)) + 1)]
    group = _groups(problem, region, charts, division.along)
    low, extent = np.zeros((len(charts), 2)), np.ones((len(charts), 2))
    for number in np.unique(group):
        own = np.flatnonzero(group == number)
        if len(own) > 1:
            faces = np.concatenate([charts[k].faces for k in own])
            for k in own:
                at = plan_coordinates(problem.vertices, problem.faces[faces])
                charts[k] = charts[k]._replace(at=at[charts[k].vertices])
        every = np.concatenate([charts[k].at for k in own])
        low[own], extent[own] = every.min(axis=0), np.maximum(np.ptp(every, axis=0), np.finfo(float).tiny)
    corners = [chart.scaled(*box) for chart, box in zip(charts, zip(low, extent))]
    strips, lines, drawn = [], [], _strips(charts, group)
    for strip, direction in zip(drawn, _directions(drawn)):
        along = [_turned(corners[k][:, :, axis], back) for k, axis, back in strip]
        lengths = np.array([extent[k, [axis, 1 - axis]] for k, axis, _ in strip]).mean(axis=0)
        if division.largest is not None:
            stretch = [_stretch(problem.vertices[problem.faces[charts[k].faces]], corners[k], axis) for k, axis, _ in strip]
            positions = _of_one_length(along, np.concatenate(stretch), division.largest[direction])
        else:
            positions = _positions(division, direction, *lengths.tolist())
        at = np.concatenate(along)
        fewest = min(len(charts[k].faces) for k, *_ in strip)
        if len(positions) >= fewest:
            raise CGCError(f"a region of {fewest} triangles cannot be divided into {len(positions)} or more panels; use larger ones")
        lines.append(np.unique([_shifted(line, at) for line in positions]))
        strips.append([Axis(*one, float(each.min()), float(each.max())) for one, each in zip(strip, along)])
    values = np.zeros((len(region), 3, 2))
    for chart, place in zip(charts, corners):
        values[chart.faces] = place
    found = GridLines(values, strips, lines)
    for chart, number in zip(charts, found.cells.tolist()):
        if number > len(chart.faces) + 0.5:
            raise CGCError(f"a region of {len(chart.faces)} triangles cannot be divided into {number:.0f} or more panels; use larger ones")
    return found


def _turned(values: FloatArray, back: bool) -> FloatArray:
    return 1.0 - values if back else values


def _chart(problem: CGCProblem, own: IntArray, along: str) -> _Chart:
    used, corners = np.unique(problem.faces[own], return_inverse=True)
    F, V = corners.reshape(-1, 3), problem.vertices[used]
    if along == "curvature":
        return _Chart(used, own, F, curvature_coordinates(V, F), False)
    square = square_coordinates(V, F)
    return _Chart(used, own, F, plan_coordinates(V, F) if square is None else square, square is not None)


def _groups(problem: CGCProblem, region: IntArray, charts: list[_Chart], along: str) -> IntArray:
    """Return the group of every region: connected regions along the axes of the plan form one, others are alone."""
    edges = edge_faces(problem.faces)
    pairs = region[edges[edges[:, 3] >= 0, 2:]]
    free = np.array([along == "plan" and not chart.square for chart in charts], dtype=bool)
    pairs = pairs[free[pairs].all(axis=1)]
    graph = sparse.csr_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(charts),) * 2)
    return connected_components(graph, directed=False)[1].astype(np.int64)


def _strips(charts: list[_Chart], group: IntArray) -> list[list[tuple[int, int, bool]]]:
    """Return the coordinates that have the same lines: region, axis, and whether it runs against the first one."""
    links: dict[tuple[int, int], list[tuple[int, int, bool]]] = {(k, axis): [] for k in range(len(charts)) for axis in (0, 1)}

    def link(one: tuple[int, int], other: tuple[int, int], back: bool) -> None:
        links[one].append((*other, back))
        links[other].append((*one, back))

    for number in np.unique(group):
        first, *others = np.flatnonzero(group == number).tolist()
        for k in others:
            for axis in (0, 1):
                link((first, axis), (k, axis), False)
    sides: dict[frozenset[int], tuple[int, int, int]] = {}
    for k, chart in enumerate(charts):
        for axis, side in _sides(chart) if chart.square else ():
            j, other, start = sides.setdefault(frozenset(side), (k, axis, side[0]))
            if j != k:
                link((j, other), (k, axis), start != side[0])
    strips: list[list[tuple[int, int, bool]]] = []
    seen: set[tuple[int, int]] = set()
    for key in links:
        if key in seen:
            continue
        seen.add(key)
        strip = [(*key, False)]
        for region, axis, turned in strip:
            for k, other, back in links[region, axis]:
                if (k, other) not in seen:
                    seen.add((k, other))
                    strip.append((k, other, turned != back))
        strips.append(strip)
    return strips


def _directions(strips: list[list[tuple[int, int, bool]]]) -> list[int]:
    """Return the direction of every strip, 0 or 1; strips that cross in a region have different ones where that is possible.

    The first coordinates of two neighbours may run along and across their common side.
    """
    owner = {(region, axis): number for number, strip in enumerate(strips) for region, axis, _ in strip}
    found: dict[int, int] = {}
    for number, strip in enumerate(strips):
        found.setdefault(number, strip[0][1])
        front = [number]
        for own in front:
            for region, axis, _ in strips[own]:
                across = owner[region, 1 - axis]
                if across not in found:
                    found[across] = 1 - found[own]
                    front.append(across)
    return [found[number] for number in range(len(strips))]


def _sides(chart: _Chart) -> list[tuple[int, list[int]]]:
    """Return the four sides of a region as an axis and the vertices along it, in the order of the coordinate."""
    unit = (chart.at - chart.at.min(axis=0)) / np.ptp(chart.at, axis=0)
    found = []
    for axis in (0, 1):
        for end in (0.0, 1.0):
            on = np.flatnonzero(np.abs(unit[:, 1 - axis] - end) < SIDE_TOLERANCE)
            found.append((axis, chart.vertices[on[np.argsort(unit[on, axis], kind="stable")]].tolist()))
    return found


def _positions(division: Division, axis: int, length: float, other: float) -> list[float]:
    """Return the positions of lines, from 0 to 1, on an axis of a length [L] beside one of another length."""
    widths = (division.columns, division.rows)[axis]
    if widths is not None:
        return _at_widths(widths, length)
    if division.size is not None:
        number = max(1, round(min(length / division.size, MAX_LINES)))
    elif division.number is not None:
        first = min(division.number, MAX_LINES, max(1, round(math.sqrt(division.number * max(length, other) / min(length, other)))))
        number = first if length >= other else max(1, round(division.number / first))
    else:
        number = 1
    return [k / number for k in range(1, number)]


def checked_widths(widths: Widths) -> list[float]:
    """Return widths of columns or rows as a list [L].

    Raises
    ------
    CGCError
        If they are not positive lengths.
    """
    each = [checked_number(width, "a width") for width in (widths if isinstance(widths, Sequence) else [widths])]
    if not each or min(each) <= 0.0:
        raise CGCError(f"the widths of columns and rows must be positive lengths, not {widths!r:.60}")
    return each


def _at_widths(widths: Widths, length: float) -> list[float]:
    """Return the positions of lines at widths [L], of which the last one is repeated; a narrow rest joins the last strip."""
    each = checked_widths(widths)
    found: list[float] = []
    at = 0.0
    while len(found) < MAX_LINES:
        at += each[min(len(found), len(each) - 1)]
        if at >= length - MIN_REST * each[-1]:
            break
        found.append(at / length)
    return found


def _stretch(places: FloatArray, at: FloatArray, axis: int) -> FloatArray:
    """Return the length on faces with corners (m, 3, 3) per unit of one of two coordinates (m, 3, 2) at these [L]."""
    ahead, along = places[:, 1:] - places[:, :1], at[:, 1:] - at[:, :1]
    area = along[:, 0, 0] * along[:, 1, 1] - along[:, 0, 1] * along[:, 1, 0]
    # The other coordinate is constant along this direction.
    other = along[:, :, 1 - axis]
    direction = (1.0 if axis == 0 else -1.0) * (other[:, 1, None] * ahead[:, 0] - other[:, 0, None] * ahead[:, 1])
    return np.linalg.norm(direction, axis=1) / np.maximum(np.abs(area), np.finfo(float).tiny)


def _of_one_length(at: list[FloatArray], stretch: FloatArray, largest: float) -> list[float]:
    """Return the positions of lines between strips of equal length along the surface, where they are longest.

    Parameters
    ----------
    at
        Coordinates at the corners of faces (m, 3), from 0 to 1, for every region.
    stretch
        (m,) length per unit of the coordinate [L].
    largest
        Length of the strips [L].
    """
    corners = np.concatenate(at)
    middle = (np.arange(SAMPLES) + 0.5) / SAMPLES
    low, high = np.searchsorted(middle, corners.min(axis=1)), np.searchsorted(middle, corners.max(axis=1))
    longest = np.zeros(SAMPLES)
    for first, last, length in zip(low.tolist(), high.tolist(), stretch.tolist()):
        longest[first:last] = np.maximum(longest[first:last], length)
    total = np.r_[0.0, np.cumsum(longest) / SAMPLES]
    number = max(1, math.ceil(total[-1] / largest - 1e-9))
    return np.interp(total[-1] * np.arange(1, number) / number, total, np.linspace(0.0, 1.0, SAMPLES + 1)).tolist()


def _shifted(line: float, at: FloatArray) -> float:
    """Return a nearby position at which a grid line follows edges, given corner coordinates (m, 3); else the line itself."""
    low, high = at.min(axis=1), at.max(axis=1)
    reach = MAX_SHIFT * float(np.median(high - low))
    near = (low <= line + 2 * reach) & (high >= line - 2 * reach)
    if not near.any():
        return line
    tries = np.unique(np.append(at[near][np.abs(at[near] - line) <= reach * (1 + SHIFT_TOLERANCE)], line))
    low, high = low[near], high[near]
    cut = [np.maximum(np.minimum(high - one, one - low), 0.0).sum() + 1e-3 * abs(one - line) for one in tries.tolist()]
    best = int(np.argmin(cut))
    return float(tries[best]) if cut[best] < FOLLOW_RATIO * cut[int(np.searchsorted(tries, line))] else line
