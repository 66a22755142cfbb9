"""Rows: flat pieces cut into strips as wide as a sheet, and these into lengths of the sheet."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import TYPE_CHECKING
from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from .nesting import nest
from .outlines import outline_loops
from .patchwork import Patchwork
from .patchwork import connected_pieces
from .patchwork import split_piece
from .pieces import CUT_TOLERANCE
from .pieces import Box
from .pieces import best_box
from .pieces import parted
from .pieces import refuse_many

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["in_rows"]

DIRECTIONS = 24  # of rows that are compared, through half a turn
OFFSETS = (None, 0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875)  # of the first row, relative to its width; None for rows of one width
MAX_PARTS = 20_000  # parts of all ways to cut that are compared, which limits the run time
SHORT_LIST = 40  # ways to cut that are compared by rotated rectangles
FILLS = (0.5, 0.0, 1.0)  # joints within a row: even, or full sheets from its start or its end
SLACK = 1e-6  # of a sheet that rows and lengths leave free, so that tolerances do not make a piece too large
MIN_AREA = 1e-9  # of a sheet, below which a part is a rounding error


class _Rows(NamedTuple):
    """A way to cut a piece into rows."""

    along: FloatArray  # (2,) unit vector along the rows
    offset: Optional[float]
    fill: float

    @property
    def frame(self) -> FloatArray:
        """Axes of the rows as columns (2, 2)."""
        return np.column_stack([self.along, [-self.along[1], self.along[0]]])

    def levels(self, low: float, high: float, width: float) -> FloatArray:
        """Return the boundaries of rows between two levels, with both ends [L]."""
        if self.offset is None:
            return np.linspace(low, high, _parts(high - low, width) + 1)
        inner = low - self.offset * width + width * np.arange(1, _parts(high - low, width) + 2)
        return np.r_[low, inner[(inner > low + SLACK * width) & (inner < high - SLACK * width)], high]

    def lengths(self, low: float, high: float, length: float) -> FloatArray:
        """Return the joints of a row between its ends, with both ends [L]."""
        count = _parts(high - low, length)
        if self.fill == 0.5:
            return np.linspace(low, high, count + 1)
        whole = length * np.arange(1, count)
        return np.r_[low, low + whole if self.fill == 0.0 else (high - whole)[::-1], high]


class _Cells(NamedTuple):
    """Parts of an outline between joints, in the axes of the rows."""

    shapes: NDArray[Any]  # (k,) polygons of shapely
    sizes: list[tuple[float, float]]  # [L]


class _Tried(NamedTuple):
    """Rows with the parts that they give."""

    rows: _Rows
    cells: _Cells
    sheets: int

    def key(self) -> tuple[int, bool, int]:
        """Return the order of preference: fewest sheets, symmetric, fewest parts."""
        return self.sheets, self.rows.offset is not None or self.rows.fill != 0.5, len(self.cells.sizes)


def in_rows(
    own: Patchwork,
    sheet: tuple[float, float],
    spacing: float,
    shortest: float,
    along: Optional[FloatArray] = None,
    turned: Optional[Mapping[int, tuple[int, FloatArray]]] = None,
) -> Patchwork:
    """Return the patchwork with every piece that is larger than a sheet cut into rows.

    Rows in several directions and positions are compared on the outline of the piece. The chosen ones have the fewest seams and parts
    smaller than a length, then need the fewest sheets, and are then preferably symmetric, with the fewest pieces. Pieces stay whole
    without shapely, and if their outline crosses itself.

    Parameters
    ----------
    own
        Pieces in the plane.
    sheet
        Length and width of the sheets [L].
    spacing
        Distance between pieces on a sheet [L].
    shortest
        Length of a short seam [L].
    along
        (p, 2) direction of the rows of every piece. Default: the best of several.
    turned
        Pieces that have the rows of an earlier piece, and the rotations ``(2, 2)`` that take its place in the plane to theirs.

    Raises
    ------
    ValueError
        If the sheet would give too many pieces.
    """
    try:
        import shapely
    except ImportError:
        return own
    refuse_many(own, sheet)
    room = sheet[0] * (1.0 - SLACK), sheet[1] * (1.0 - SLACK)
    pieces, found = outline_loops(own), dict[int, _Rows]()
    for piece, loops in enumerate(pieces):
        box = best_box(loops[0].points, sheet, None if along is None else along[piece])
        outline = shapely.Polygon(loops[0].points, [loop.points for loop in loops[1:]])
        if box.parts > 1 and outline.is_valid:
            before, turn = (turned or {}).get(piece, (piece, np.eye(2)))
            if before in found:
                found[piece] = found[before]._replace(along=turn @ found[before].along)
            else:
                found[piece] = _best(outline, box, room, spacing, shortest, along is not None)
            own = _cut(own, piece, found[piece], room)
    return connected_pieces(own)


def _best(outline: Any, box: Box, room: tuple[float, float], spacing: float, shortest: float, fixed: bool) -> _Rows:
    """Return the best rows of an outline."""
    turns = np.pi * np.arange(1 if fixed else DIRECTIONS) / DIRECTIONS
    # Rows along and across the rectangle first, as the number of comparisons is limited.
    turns = turns[np.argsort(np.round(np.abs(np.sin(2.0 * turns)), 9), kind="stable")]
    axes = [np.cos(turn) * box.along + np.sin(turn) * np.array([-box.along[1], box.along[0]]) for turn in turns]
    tried: list[_Tried] = []
    parts = 0
    for direction, offset in itertools.product(axes, OFFSETS):
        if parts > MAX_PARTS:
            break
        bands = _bands(outline, _Rows(direction, offset, FILLS[0]), room)
        for fill in FILLS:
            if parts > MAX_PARTS:
                break
            rows = _Rows(direction, offset, fill)
            cells = _cells(bands, rows, room)
            tried.append(_Tried(rows, cells, _sheets(cells.sizes, room, spacing)))
            parts += len(cells.sizes)
    tried.sort(key=_Tried.key)
    # Rectangles rotated to fit each part need fewer sheets, and more time.
    closer = [own._replace(sheets=_sheets(_rotated(own.cells, room, fixed), room, spacing)) for own in tried[:SHORT_LIST]]
    fewest, best = np.inf, tried[0]
    for own in [*sorted(closer, key=_Tried.key), *tried[SHORT_LIST:]]:
        short = _too_small(own.cells, shortest)
        if short < fewest:
            fewest, best = short, own
        if not short:
            break
    return best.rows


def _rotated(cells: _Cells, room: tuple[float, float], fixed: bool) -> list[tuple[float, float]]:
    """Return the sides of the best rectangles around the parts, along the rows if their direction is fixed [L]."""
    import shapely

    along = np.array([1.0, 0.0]) if fixed else None
    boxes = [best_box(shapely.get_coordinates(shape), room, along) for shape in cells.shapes]
    return [(min(box.length, room[0]), min(box.width, room[1])) for box in boxes]


def _parts(extent: float, full: float) -> int:
    return max(1, int(np.ceil(extent / full - 1e-12)))


def _bands(outline: Any, rows: _Rows, room: tuple[float, float]) -> NDArray[Any]:
    """Return the parts of an outline between the boundaries of rows, in the axes of the rows; their fill plays no part."""
    import shapely

    turned = shapely.transform(outline, lambda points: points @ rows.frame)
    left, low, right, high = turned.bounds
    levels = rows.levels(low, high, room[1])
    boxes = shapely.box(left - 1.0, levels[:-1], right + 1.0, levels[1:])
    return _polygons(shapely.intersection(turned, boxes, grid_size=_grid(room)), room)


def _grid(room: tuple[float, float]) -> float:
    """Return the grid to which coordinates are rounded, so that the boundaries of neighbours coincide [L]."""
    return SLACK * SLACK * room[1]


def _cells(bands: NDArray[Any], rows: _Rows, room: tuple[float, float]) -> _Cells:
    """Return the parts of the bands of rows between their joints."""
    import shapely

    ends = shapely.bounds(bands)
    joints = [rows.lengths(a, b, room[0]) for a, b in ends[:, [0, 2]].tolist()]
    # Clipping is much faster than a general intersection, and neighbours end at exactly the same joint.
    clipped = [
        shapely.clip_by_rect(band, start, low - 1.0, end, high + 1.0)
        for band, (_, low, _, high), own in zip(bands, ends.tolist(), joints)
        for start, end in zip(own[:-1], own[1:])
    ]
    shapes = _polygons(np.array(clipped, dtype=object), room)
    boxes = shapely.bounds(shapes)
    return _Cells(shapes, [(float(x), float(y)) for x, y in np.minimum(boxes[:, 2:] - boxes[:, :2], room)])


def _polygons(shapes: NDArray[Any], room: tuple[float, float]) -> NDArray[Any]:
    """Return the polygons of shapes, without rounding errors."""
    import shapely

    parts = shapely.get_parts(shapes)
    return parts[(shapely.get_dimensions(parts) == 2) & (shapely.area(parts) > MIN_AREA * room[0] * room[1])]


def _sheets(sizes: list[tuple[float, float]], room: tuple[float, float], spacing: float) -> int:
    """Return the number of sheets of rectangles; those that fill a sheet need not be nested."""
    full = [x > room[0] * (1 - 10 * SLACK) and y > room[1] * (1 - 10 * SLACK) for x, y in sizes]
    rest = [size for size, whole in zip(sizes, full) if not whole]
    return sum(full) + (1 + max(place.sheet for place in nest(rest, room, spacing)) if rest else 0)


def _too_small(cells: _Cells, shortest: float) -> int:
    """Return the number of parts narrower than a length, and of pairs of parts that share a shorter boundary [L]."""
    import shapely

    if not shortest:
        return 0
    one, other = shapely.STRtree(cells.shapes).query(cells.shapes, predicate="intersects")
    one, other = one[one < other], other[one < other]
    rims = shapely.boundary(cells.shapes)
    common = shapely.length(shapely.intersection(rims[one], rims[other], grid_size=SLACK * shortest))
    narrow = sum(min(size) < shortest for size in cells.sizes)
    return narrow + int(((common > SLACK * shortest) & (common < shortest)).sum())


def _cut(own: Patchwork, piece: int, rows: _Rows, room: tuple[float, float]) -> Patchwork:
    """Cut a piece into rows, and every part of a row into lengths."""
    along, across = rows.frame.T
    heights = own.plane[own.piece == piece] @ across
    own, parts = _cut_at(own, piece, across, rows.levels(float(heights.min()), float(heights.max()), room[1])[1:-1])
    for part in parts:
        places = own.plane[own.piece == part] @ along
        own, _ = _cut_at(own, part, along, rows.lengths(float(places.min()), float(places.max()), room[0])[1:-1])
    return own


def _cut_at(own: Patchwork, piece: int, normal: FloatArray, levels: FloatArray) -> tuple[Patchwork, list[int]]:
    """Cut a piece at levels along a normal, and return the connected parts."""
    tolerance = CUT_TOLERANCE * float(np.ptp(own.plane[own.piece == piece] @ normal))
    parts = [piece]
    for level in levels.tolist():
        for part in list(parts):
            heights = own.plane[own.piece == part] @ normal
            if heights.min() < level - tolerance and heights.max() > level + tolerance:
                before = int(own.piece.max())
                own = parted(split_piece(own, part, normal, level, tolerance), part)
                parts += range(before + 1, int(own.piece.max()) + 1)
    return own, parts
