"""Plan, sections and elevations of a surface."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from functools import partial
from typing import NamedTuple

import numpy as np

from ...discrete import vertex_normals
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...meshing import boundary_loops
from ...meshing.visibility import in_sight
from ...model.problem import CGCProblem
from ..drawing import Line
from ..drawing import segment_distances
from ..figures import metres
from ..picture_key import ARROW
from ..picture_key import north_arrow
from .level_lines import level_lines
from .marks import GAP
from .marks import TEXT_HEIGHT
from .marks import Label
from .marks import View
from .marks import arrow
from .marks import cut_for
from .marks import dimension
from .marks import height_mark
from .marks import letters
from .marks import outside
from .notes import region_labels
from .notes import support_heights
from .setting_out import chain
from .setting_out import set_out

__all__ = ["UPRIGHT_PADDING", "Cut", "Shape", "elevation", "plan", "section"]

PADDING = np.array([[24.0, 24.0], [14.0, 14.0]])  # of the plan: left and below, right and above [mm]
UPRIGHT_PADDING = np.array([[24.0, 12.0], [5.0, 5.0]])  # of sections and elevations: left and below, right and above [mm]
DIMENSION_AT = 14.0  # distance of dimensions from the plan [mm]
CHAIN_AT, CHAIN_ROOM = 12.0, 6.0  # distance of chains of dimensions from the plan, and by how much the whole ones are farther off [mm]
SUPPORT_SIZE = 2.4  # of the symbol of a single support [mm]
LETTER_AT = 7.0  # distance of the ends of section lines from the plan [mm]
NORTH_LENGTH = 9.0  # [mm]
MIN_LABEL_ROOM = 3.0  # length of a contour relative to its text, below which it has no text
SUPPORT_TOLERANCE = 1e-9  # distance in front of a section at which a support is shown, relative to the size
PIECES = 2  # of a segment, for visibility
BESIDE_RATIO = 5e-3  # distance from a silhouette at which its visibility is tested, relative to the size
UP = np.array([0.0, 0.0, 1.0])


class Cut(NamedTuple):
    """A vertical plane."""

    letter: str
    start: FloatArray  # (2,) a point in plan [L]
    along: FloatArray  # (2,) unit direction, to the right in the view


class Shape:
    """A surface with the lines that all views show.

    Parameters
    ----------
    problem
        The surface, without dummies.
    """

    def __init__(self, problem: CGCProblem):
        self.problem = problem
        self.vertices, self.faces = problem.vertices, problem.faces
        used = np.unique(self.faces)
        self.low, self.high = self.vertices[used].min(axis=0), self.vertices[used].max(axis=0)
        self.digits = max(0, round(np.log10(1000.0 * metres(problem.drawing.units))))

    def number(self, length: float) -> str:
        """Return a length in the units of the drawing as text, to the millimetre."""
        return f"{length:.{self.digits}f}"

    @cached_property
    def chains(self) -> list[FloatArray]:
        """Distances from the left and from the top at which dimensions of a chain meet, to the millimetre [L]; empty without chains."""
        from_corner = (set_out(self)[:, :2] - [self.low[0], self.high[1]]) * [1.0, -1.0]
        found = [np.unique(np.round(own, self.digits)) for own in from_corner.T]
        return found if max(map(len, found)) > 2 else []

    @cached_property
    def plan_padding(self) -> FloatArray:
        """Room of the plan: left and below, right and above (2, 2) [mm]."""
        return PADDING + (CHAIN_ROOM * np.array([[1.0], [0.0]]) if self.chains else 0.0)

    def levels(self, interval: float) -> list[float]:
        """Return the multiples of an interval between the lowest and the highest point."""
        first, last = np.floor(self.low[2] / interval) + 1, np.ceil(self.high[2] / interval) - 1
        return (np.arange(first, last + 1) * interval).tolist()

    @cached_property
    def outlines(self) -> list[IntArray]:
        """Closed paths of vertices along the boundary; the last vertex is the first."""
        return [np.append(loop, loop[0]) for loop in boundary_loops(self.faces)]

    @cached_property
    def creases(self) -> list[IntArray]:
        """Paths of vertices along creases."""
        return [np.array(path) for path in self.problem.crease_paths()]

    @cached_property
    def held_lines(self) -> list[IntArray]:
        """Supported parts of outlines and creases with two or more vertices."""
        held = np.zeros(len(self.vertices), bool)
        held[self.problem.supports] = True
        found = []
        for path in (*self.outlines, *self.creases):
            both = held[path[:-1]] & held[path[1:]]
            found += [path[part[0] : part[-1] + 2] for part in _runs(both)]
        return found

    @cached_property
    def held_points(self) -> IntArray:
        """Supports that are not on supported lines."""
        on_lines = np.concatenate([np.empty(0, np.int64), *self.held_lines])
        return np.setdiff1d(self.problem.supports, on_lines)

    @cached_property
    def height_of_supports(self) -> str:
        """The height of all supports as text, empty if they differ or there are none."""
        heights = {self.number(height + 0.0) for height in self.vertices[self.problem.supports, 2].tolist()}
        return heights.pop() if len(heights) == 1 else ""

    def silhouettes(self, eye: FloatArray) -> list[tuple[FloatArray, FloatArray]]:
        """Return the lines where regions turn away from a viewer in a direction (3,), and points beside them for their visibility.

        Lines and points are polylines ``(k, 3)`` [L].
        """
        number, found = self.problem.regions(), list[FloatArray]()
        for region in range(int(number.max()) + 1):
            faces = self.faces[number == region]
            normals = vertex_normals(self.vertices, faces)
            found += level_lines(np.hstack([self.vertices, normals]), faces, normals @ eye, 0.0)
        # Facets beside a line may hide it although the smooth surface would not.
        beside = BESIDE_RATIO * float(np.linalg.norm(self.high - self.low))
        return [(line[:, :3], line[:, :3] + beside * line[:, 3:]) for line in found]


def _runs(mask: np.ndarray) -> list[IntArray]:
    """Return the positions of consecutive true values, one array per run."""
    at = np.flatnonzero(mask)
    return [run for run in np.split(at, np.flatnonzero(np.diff(at) > 1) + 1) if len(run)]


def plan(shape: Shape, scale: float, interval: float, cuts: Sequence[Cut], north: FloatArray) -> View:
    """Return the plan with outlines, creases, regions, contour lines, supports with heights, section lines and the north arrow.

    Parameters
    ----------
    shape
        The surface.
    scale
        Millimetres of the sheet per unit of length of the surface.
    interval
        Height between contour lines [L].
    cuts
        Planes of the sections.
    north
        ``(2,)`` direction of north in plan.
    """
    origin, padding = shape.low[:2], shape.plan_padding

    def put(points: FloatArray) -> FloatArray:
        return scale * (points[:, :2] - origin) + padding[0]

    size = scale * (shape.high - shape.low)[:2]
    lines: list[Line] = []
    ends = [[put(at[None])[0] for at in _across(cut, shape)] for cut in cuts]
    low, high = padding[0], padding[0] + size
    middle = np.array([high[0] + padding[1, 0] - 5.0, high[1] + padding[1, 1] - 6.0])
    arrow_room = Label("TEXT", "N", middle, NORTH_LENGTH + 2.0 * TEXT_HEIGHT)
    edges = _segments([put(shape.vertices[path]) for path in (*shape.outlines, *shape.creases)])
    labels = region_labels(shape, put(shape.vertices), edges)
    boxes = [own.box for own in labels]
    labels += support_heights(shape, put(shape.vertices), [*labels, arrow_room])
    edges = np.concatenate([edges, np.array(ends).reshape(-1, 2, 2)])
    contours = [
        (level, put(line))
        for level in shape.levels(interval)
        for line in level_lines(shape.vertices, shape.faces, shape.vertices[:, 2], level)
    ]
    each = [edges, *(_segments([line]) for _, line in contours)]
    segments, owner = np.concatenate(each), np.repeat(np.arange(len(each)) - 1, [len(own) for own in each])
    first, last = segments.min(axis=1), segments.max(axis=1)

    def room(at: FloatArray, number: int) -> float:
        """Return the smallest distance of points (p, 2) on a contour from all other lines and texts [mm]; far lines do not count."""
        near = (first < at.max(axis=0) + TEXT_HEIGHT).all(axis=1) & (last > at.min(axis=0) - TEXT_HEIGHT).all(axis=1) & (owner != number)
        taken = np.array([own.box for own in labels if not own.angle] or np.empty((0, 2, 2)))
        level = np.maximum(np.maximum(taken[:, 0] - at[:, None], at[:, None] - taken[:, 1]), 0.0)
        turned = np.array([own.place for own in labels if own.angle]).reshape(-1, 2)
        half = np.array([0.5 * letters(own.text, own.height) for own in labels if own.angle])
        distances = (
            segment_distances(at, segments[near]),
            np.linalg.norm(level, axis=2) + GAP,
            np.linalg.norm(at[:, None] - turned, axis=2) - half,
        )
        return float(min(own.min(initial=np.inf) for own in distances))

    for k, (level, line) in enumerate(contours):
        parts, text = [line], _height(level, interval)
        if np.linalg.norm(np.diff(line, axis=0), axis=1).sum() > MIN_LABEL_ROOM * letters(text):
            parts, label = cut_for(line, text, partial(room, number=k))
            labels += [label] if label else []
        lines += [Line("CONTOUR", rest) for part in parts for rest in outside(part, boxes)]
    lines += [Line("CREASE", put(shape.vertices[path])) for path in shape.creases]
    lines += [Line("OUTLINE", put(shape.vertices[path])) for path in shape.outlines]
    lines += [Line("SUPPORT", put(shape.vertices[path])) for path in shape.held_lines]
    half = 0.5 * SUPPORT_SIZE * np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
    lines += [Line("SUPPORT", at + half, closed=True) for at in put(shape.vertices[shape.held_points])]
    for cut, (start, end) in zip(cuts, ends):
        along = (end - start) / np.linalg.norm(end - start)
        towards = np.array([-along[1], along[0]])
        start, end = start - LETTER_AT * along, end + LETTER_AT * along
        lines += [Line("SECTION", part) for part in outside(np.stack([start, end]), boxes)]
        for at in (start, end):
            lines += arrow(at, at + 4.0 * towards, "SECTION")
            labels.append(Label("SECTION", cut.letter, at - 2.4 * towards, 1.4 * TEXT_HEIGHT))
    for axis, start, along in ((0, low, np.array([1.0, 0.0])), (1, np.array([low[0], high[1]]), np.array([0.0, -1.0]))):
        beside = DIMENSION_AT + (CHAIN_ROOM if shape.chains else 0.0)
        drawn, label = dimension(start, start + size[axis] * along, shape.number(size[axis] / scale), beside)
        lines += drawn
        labels.append(label)
        places = shape.chains[axis] if shape.chains else np.empty(0)
        if len(places) > 2:
            drawn, texts = chain(scale * places, [shape.number(own) for own in np.diff(places).tolist()], start, along, CHAIN_AT)
            lines += drawn
            labels += texts
    marks = north_arrow(np.append(north / np.linalg.norm(north), 0.0), NORTH_LENGTH / ARROW).moved(middle)
    lines += [Line("FRAME", line) for line in marks.lines]
    labels += [Label("TEXT", text, place + [0.5 * letters(text, NORTH_LENGTH / ARROW), 0.0]) for text, place in marks.texts]
    return _named("Plan", lines, labels, size + padding.sum(axis=0))


def _segments(lines: Sequence[FloatArray]) -> FloatArray:
    """Return the segments of polylines (k, 2, 2)."""
    return np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in lines])


def _height(level: float, interval: float) -> str:
    digits = len(f"{interval:.6f}".rstrip("0").partition(".")[2])
    return f"{level + 0.0:.{digits}f}"


def _across(cut: Cut, shape: Shape) -> tuple[FloatArray, FloatArray]:
    """Return the ends of a section line across the surface in plan (3,)."""
    corners = np.array([[x, y] for x in (shape.low[0], shape.high[0]) for y in (shape.low[1], shape.high[1])])
    along = (corners - cut.start) @ cut.along
    first, last = (np.append(cut.start + own * cut.along, 0.0) for own in (along.min(), along.max()))
    return first, last


def section(shape: Shape, scale: float, cut: Cut) -> View:
    """Return the line in which a vertical plane cuts the surface, and the visible outlines and creases beyond."""
    along = np.append(cut.along, 0.0)
    eye = np.cross(along, UP)
    behind = -(shape.vertices - np.append(cut.start, 0.0)) @ eye
    lines = [("CUT", line) for line in level_lines(shape.vertices, shape.faces, behind, 0.0)]
    beyond = shape.faces[(behind[shape.faces] >= 0).all(axis=1)]
    hidden_by = shape.faces[(behind[shape.faces] > 0).any(axis=1)]
    if len(beyond):
        edges = [shape.vertices[path] for path in (*shape.outlines, *shape.creases)]
        for line, beside in (*zip(edges, edges), *shape.silhouettes(eye)):
            keep = -(line - np.append(cut.start, 0.0)) @ eye > 0
            for run in _runs(keep):
                if len(run) > 1:
                    lines += [("BEYOND", seen) for seen in _visible(line[run], beside[run], shape.vertices, hidden_by, along, eye)]
    held = shape.held_points[behind[shape.held_points] >= -SUPPORT_TOLERANCE * float(np.ptp(behind))]
    return _upright(f"Section {cut.letter}-{cut.letter}", shape, scale, along, lines, held)


def elevation(shape: Shape, scale: float, name: str, towards: FloatArray) -> View:
    """Return the visible outlines, creases and silhouettes of the surface.

    Parameters
    ----------
    shape
        The surface.
    scale
        Millimetres of the sheet per unit of length of the surface.
    name
        Side of the viewer.
    towards
        ``(2,)`` unit vector in plan from the surface to the viewer.
    """
    eye = np.append(towards, 0.0)
    along = np.cross(UP, eye)
    lines = []
    edges = (("OUTLINE", shape.outlines), ("CREASE", shape.creases), ("SUPPORT", shape.held_lines))
    paths = [("OUTLINE", *own) for own in shape.silhouettes(eye)]
    paths += [(layer, shape.vertices[path], shape.vertices[path]) for layer, own in edges for path in own]
    for layer, line, beside in paths:
        lines += [(layer, seen) for seen in _visible(line, beside, shape.vertices, shape.faces, along, eye)]
    axes = np.stack([along, UP, eye])
    seen = in_sight(shape.vertices[shape.held_points] @ axes.T, shape.vertices @ axes.T, shape.faces)
    return _upright(f"{name} elevation", shape, scale, along, lines, shape.held_points[seen])


def _visible(
    line: FloatArray, beside: FloatArray, vertices: FloatArray, faces: IntArray, along: FloatArray, eye: FloatArray
) -> list[FloatArray]:
    """Return the parts of a polyline (k, 3) at which no face hides another polyline (k, 3) beside it."""
    axes = np.stack([along, UP, eye])
    place, at = np.arange(PIECES * (len(line) - 1) + 1) / PIECES, np.arange(len(line))
    fine, tested = (np.stack([np.interp(place, at, own[:, axis]) for axis in range(3)], axis=1) for own in (line, beside))
    seen = in_sight(0.5 * (tested[1:] + tested[:-1]) @ axes.T, vertices @ axes.T, faces)
    return [fine[run[0] : run[-1] + 2] for run in _runs(seen)]


def _upright(name: str, shape: Shape, scale: float, along: FloatArray, drawn: Sequence[tuple[str, FloatArray]], held: IntArray) -> View:
    """Return a section or elevation with the ground line, some of the single supports, and the lowest and highest heights."""
    every = shape.vertices[np.unique(shape.faces)] @ along
    low = np.array([every.min(), shape.low[2]])
    size = scale * np.array([np.ptp(every), shape.high[2] - shape.low[2]])

    def put(points: FloatArray) -> FloatArray:
        return scale * (np.stack([points @ along, points[:, 2]], axis=1) - low) + UPRIGHT_PADDING[0]

    lines = [Line(layer, put(points)) for layer, points in drawn]
    labels = []
    foot = 0.5 * SUPPORT_SIZE * np.array([[0.0, 0.0], [1, -1.6], [-1, -1.6]])
    lines += [Line("SUPPORT", at + foot, closed=True) for at in put(shape.vertices[held])]
    for height in sorted({shape.low[2], shape.high[2]}):
        level = scale * (height - shape.low[2]) + UPRIGHT_PADDING[0, 1]
        lines.append(Line("GROUND", np.array([[UPRIGHT_PADDING[0, 0] - 3.0, level], [UPRIGHT_PADDING[0, 0] + size[0] + 3.0, level]])))
        # Marks of a flat surface would cover each other.
        if height == shape.low[2] or size[1] > 1.5 * TEXT_HEIGHT:
            mark, label = height_mark(np.array([UPRIGHT_PADDING[0, 0] - 3.0, level]), shape.number(height + 0.0))
            lines += mark
            labels.append(label)
    return _named(name, lines, labels, size + UPRIGHT_PADDING.sum(axis=0))


def _named(name: str, lines: list[Line], labels: list[Label], whole: FloatArray) -> View:
    """Return a view of a size with its name below."""
    title = Label("TEXT", name, np.array([0.5 * whole[0], 3.0]), 1.4 * TEXT_HEIGHT)
    return View(name, lines, [*labels, title], whole)
