"""Drawing of sheets: lines and texts by layer, independent of file formats."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..errors import CGCError
from ..errors import names_what_was_meant
from .figures import in_mm
from .figures import metres
from .outlines import Loop
from .outlines import Seam
from .patchwork import EDGE
from .patterns import Patterns
from .patterns import refuse_others
from .rulings import MAX_BOW

__all__ = ["LAYERS", "Drawing", "Line", "Text", "clearance", "draw_sheets", "folded", "roomiest"]

# Layers with their RGB colours.
LAYERS = {
    "SHEET": (150, 150, 150),
    "CUT": (200, 30, 30),
    "OUTLINE": (20, 130, 140),
    "FOLD_UP": (30, 80, 200),
    "FOLD_DOWN": (150, 40, 160),
    "RULING": (40, 150, 70),
    "MARK": (230, 140, 20),
    "LABEL": (30, 30, 30),
    "SEAM": (230, 140, 20),
    "NODE": (120, 120, 120),
}
SHEET_GAP = 0.1  # between sheets, relative to the sheet length
MARK_LENGTH = 0.012  # relative to the sheet length
MIN_FOLD = np.radians(1.0)  # least angle of an edge that is drawn as a fold
LETTER_WIDTH = 0.8  # relative to its height
ROOM_RATIO = 0.9  # accepted room for a label, relative to the largest
MIN_NUMBER_SIZE = 0.2  # relative to the text height; smaller node numbers are omitted


class Line(NamedTuple):
    """A polyline."""

    layer: str
    points: FloatArray  # (k, 2) [L]
    closed: bool = False


class Text(NamedTuple):
    """A line of text, centred at a point."""

    layer: str
    text: str
    place: FloatArray  # (2,) [L]
    height: float  # [L]


class Drawing(NamedTuple):
    """All sheets side by side."""

    lines: list[Line]
    texts: list[Text]
    size: tuple[float, float]  # from the origin [L]
    units: Optional[str]  # such as ``Meters``
    hidden: tuple[str, ...] = ()  # layers that are initially off

    def within(self, units: str) -> Drawing:
        """Return the drawing in other units, such as ``Millimeters``."""
        scale = metres(self.units) / metres(units)
        lines = [line._replace(points=scale * line.points) for line in self.lines]
        texts = [text._replace(place=scale * text.place, height=scale * text.height) for text in self.texts]
        return Drawing(lines, texts, (scale * self.size[0], scale * self.size[1]), units, self.hidden)


@names_what_was_meant()
def draw_sheets(patterns: Patterns, fold: float = MIN_FOLD, nodes: bool = True, sheet: Optional[int] = None) -> Drawing:
    """Return a drawing of patterns with outlines, allowances, folds, rulings, marks, labels and node numbers.

    Parameters
    ----------
    patterns
        Result of :func:`compas_cgc.fabrication.unroll`.
    fold
        Least angle between two faces whose edge is drawn as a fold [rad].
    nodes
        Whether to number the nodes along outlines.
    sheet
        Number of the sheet to draw, from 0. Default: all.

    Returns
    -------
    Drawing
        Lines and texts by layer [L]; all sheets in a grid, or one at the origin.

    Raises
    ------
    CGCError
        If the argument is not a Patterns object, or the sheet does not exist.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import unroll
    >>> patterns = unroll(compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm"))), (3.0, 1.5))
    >>> sorted({line.layer for line in draw_sheets(patterns).lines})
    ['CUT', 'FOLD_DOWN', 'FOLD_UP', 'MARK', 'RULING', 'SHEET']
    """
    refuse_others(patterns, "sheets are drawn", "draw_sheets")
    if sheet is not None and sheet not in range(patterns.sheets):
        raise CGCError(f"there is no sheet {sheet!r}; the patterns have sheets 0 to {patterns.sheets - 1}")
    length, width = patterns.sheet or _extent(patterns)
    step = (1.0 + SHEET_GAP) * np.array([length, width])
    drawn = range(patterns.sheets) if sheet is None else [int(sheet)]
    across = max(1, int(np.ceil(np.sqrt(len(drawn) * width / length))))
    rows = -(-len(drawn) // across)
    # The first sheet is at the upper left.
    origins = {own: np.array([k % across, rows - 1 - k // across]) * step for k, own in enumerate(drawn)}
    mark, height = MARK_LENGTH * length, 0.5 * MARK_LENGTH * length
    lines: list[Line] = []
    texts: list[Text] = []
    for number, origin in origins.items():
        if patterns.sheet is not None:
            x, y = patterns.sheet_sizes[number]
            corners = np.array([[0, 0], [x, 0], [x, y], [0, y]], dtype=np.float64)
            lines.append(Line("SHEET", corners + origin, True))
            texts.append(Text("SHEET", _title(patterns, number), origin + [0.5 * x, y + 2.0 * height], 2.0 * height))
    names = patterns.patchwork.names
    ticked: list[set[int]] = [set() for _ in patterns.pieces]
    for seam in patterns.seams:
        for side in seam.pieces:
            ticked[side].update(seam.nodes[_marks_of(seam, mark).nodes].tolist())
    for number, piece in enumerate(patterns.pieces):
        if piece.sheet not in origins:
            continue
        origin = origins[piece.sheet]
        # With an allowance the outline is where pieces meet, not where they are cut.
        outlines = [loop.points + origin for loop in piece.loops]
        lines += [Line("CUT", points, True) for points in ([loop + origin for loop in piece.allowance] or outlines)]
        lines += [Line("OUTLINE", points, True) for points in (outlines if piece.allowance else [])]
        lines += _fold_lines(patterns, number, fold, origin)
        own = patterns.patchwork
        place, room = roomiest(own.plane[own.piece == number].mean(axis=1), [loop.points for loop in piece.loops])
        # The circle of free room around the label contains its corners.
        half = 0.5 * np.hypot(LETTER_WIDTH * len(piece.label), 1.0)
        texts.append(Text("LABEL", piece.label, place + origin, float(min(4.0 * height, 0.95 * room / half))))
        if nodes:
            texts += [text for loop in piece.loops for text in _node_numbers(loop, names, ticked[number], mark, height, origin)]
    for ruling in patterns.rulings:
        if patterns.pieces[ruling.piece].sheet in origins:
            lines.append(Line("RULING", ruling.points + origins[patterns.pieces[ruling.piece].sheet]))
    for seam in patterns.seams:
        for side in (0, 1):
            if patterns.pieces[seam.pieces[side]].sheet not in origins:
                continue
            origin = origins[patterns.pieces[seam.pieces[side]].sheet]
            mate = patterns.pieces[seam.pieces[1 - side]].label
            marks, text = _seam_marks(seam, side, mate, mark, height)
            lines += [Line("MARK", points + origin) for points in marks]
            texts.append(text._replace(place=text.place + origin))
    size = step * [across, rows] - [SHEET_GAP * length, SHEET_GAP * width]
    return Drawing(lines, texts, (float(size[0]), float(size[1])), patterns.problem.drawing.units, _hidden(patterns, fold))


def _title(patterns: Patterns, number: int) -> str:
    """Return the title of a sheet: number, size, pieces, visible side, and what cut lines are."""
    size = in_mm(patterns.sheet_sizes[number], patterns.problem.drawing.units)
    labels = ", ".join(piece.label for piece in patterns.pieces if piece.sheet == number)
    units, stock = patterns.problem.drawing.units, patterns.stock
    cut = f"CUT: middle of a kerf of {in_mm([stock.kerf], units)}" if stock.kerf else "CUT: edge, without kerf"
    allowance = f", with an allowance of {in_mm([stock.allowance], units)}" if stock.allowance else ""
    return f"sheet {number + 1} of {patterns.sheets}, {size}: {labels}; seen from outside; {cut}{allowance}"


def folded(patterns: Patterns, fold: float = MIN_FOLD) -> Mask:
    """Return the mask of face sides (m, 3) folded by at least an angle; rolled and pressed pieces have none."""
    rolled = [region for region, own in patterns.straightness.items() if own.median <= MAX_BOW]
    flat = [own.region for own in patterns.unrollings if own.unrolled and own.region not in rolled]
    return np.isin(patterns.patchwork.region, flat)[:, None] & (np.abs(patterns.folds) >= fold)


def _hidden(patterns: Patterns, fold: float) -> tuple[str, ...]:
    """Return the fold layers if no piece is really folded, because the surface is rolled or pressed."""
    return () if folded(patterns, fold).any() else ("FOLD_UP", "FOLD_DOWN")


def _extent(patterns: Patterns) -> tuple[float, float]:
    """Return the length and width of the pieces with allowances, used for an unlimited sheet [L]."""
    edges = [loop for piece in patterns.pieces for loop in piece.allowance or [own.points for own in piece.loops]]
    high = np.concatenate(edges).max(axis=0) + patterns.stock.margin
    return float(high[0]), float(high[1])


def _fold_lines(patterns: Patterns, piece: int, fold: float, origin: FloatArray) -> list[Line]:
    own = patterns.patchwork
    angle = np.where((own.piece == piece)[:, None] & (own.side == EDGE), patterns.folds, 0.0)
    # Both sides of an edge have the same angle; draw one.
    u, v = own.faces, np.roll(own.faces, -1, axis=1)
    chosen = (np.abs(angle) >= fold) & (u < v)
    start, end = own.plane[chosen], np.roll(own.plane, -1, axis=1)[chosen]
    layers = np.where(angle[chosen] > 0, "FOLD_UP", "FOLD_DOWN")
    return [Line(str(layer), np.array([a, b]) + origin) for layer, a, b in zip(layers, start, end)]


def roomiest(centres: FloatArray, loops: Sequence[FloatArray]) -> tuple[FloatArray, float]:
    """Return the best face centre for a label, far from outlines and near the middle, and its distance from outlines [L]."""
    centres = centres[:: max(1, len(centres) // 200)]
    start = np.concatenate(loops)
    end = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
    along = end - start
    from_start = centres[:, None] - start
    share = np.einsum("pkj,kj->pk", from_start, along) / np.maximum(np.einsum("kj,kj->k", along, along), np.finfo(float).tiny)
    away = np.linalg.norm(from_start - np.clip(share, 0.0, 1.0)[..., None] * along, axis=2).min(axis=1)
    off = np.linalg.norm(centres - 0.5 * (start.min(axis=0) + start.max(axis=0)), axis=1)
    best = int(np.argmin(np.where(away >= ROOM_RATIO * away.max(), off, np.inf)))
    return centres[best], float(away[best])


def _node_numbers(loop: Loop, names: IntArray, ticked: set[int], mark: float, height: float, origin: FloatArray) -> list[Text]:
    """Return the node numbers of an outline, inside it and its marks, without those too small to read."""
    ahead, back = np.roll(loop.points, -1, axis=0) - loop.points, loop.points - np.roll(loop.points, 1, axis=0)
    near = np.minimum(np.linalg.norm(ahead, axis=1), np.linalg.norm(back, axis=1))
    inward = _unit(np.column_stack([-(_unit(ahead) + _unit(back))[:, 1], (_unit(ahead) + _unit(back))[:, 0]]))
    # Along a bisector the distance to the sides is shorter.
    slant = np.clip(np.abs(np.einsum("ij,ij->i", inward, np.column_stack([-_unit(ahead)[:, 1], _unit(ahead)[:, 0]]))), 0.3, 1.0)
    texts = []
    for node, point, direction, room, share in zip(loop.nodes.tolist(), loop.points, inward, near, slant.tolist()):
        size = float(min(0.7 * height, 0.3 * room))
        if size >= MIN_NUMBER_SIZE * height:
            text = str(names[node])
            away = clearance(text, size, direction) / share + (mark if node in ticked else 0.0)
            texts.append(Text("NODE", text, point + away * direction + origin, size))
    return texts


def clearance(text: str, size: float, direction: FloatArray) -> float:
    """Return the distance of the middle of a text from a line perpendicular to `direction` at which they do not overlap [L]."""
    return 0.5 * LETTER_WIDTH * size * len(text) * abs(float(direction[0])) + 0.5 * size * abs(float(direction[1])) + 0.4 * size


class _Marks(NamedTuple):
    """Marks of a seam, the same on both sides."""

    nodes: IntArray  # (k,) positions of marked nodes along the seam
    middle: int  # edge marked at its middle if no node is marked, else -1


def _marks_of(seam: Seam, mark: float) -> _Marks:
    """Return up to nine nodes of a seam at sufficient distances from its ends and each other, or else its longest edge."""
    length = np.linalg.norm(np.diff(seam.sides[0], axis=0), axis=1)
    at = np.r_[0.0, np.cumsum(length)]
    apart = max(1.5 * mark, at[-1] / 9.0)
    chosen: list[int] = []
    for k in range(1, len(at) - 1):
        if at[k] - (at[chosen[-1]] if chosen else 0.0) >= apart - 0.25 * mark and at[-1] - at[k] >= 1.5 * mark:
            chosen.append(k)
    return _Marks(np.array(chosen, dtype=np.int64), -1 if chosen else int(np.argmax(length)))


def _seam_marks(seam: Seam, side: int, mate: str, mark: float, height: float) -> tuple[list[FloatArray], Text]:
    """Return the ticks of a seam on one side, and its number with the label of the neighbouring piece."""
    points = seam.sides[side]
    along = _unit(np.diff(points, axis=0))
    at_node = _unit(np.vstack([along[:1], along[1:] + along[:-1], along[-1:]]))
    turn = np.array([[0.0, 1.0], [-1.0, 0.0]]) * (1.0 if side == 0 else -1.0)
    where = _marks_of(seam, mark)
    ticks = [np.array([points[k], points[k] + mark * (at_node[k] @ turn)]) for k in where.nodes]
    if where.middle >= 0:
        middle = 0.5 * (points[where.middle] + points[where.middle + 1])
        ticks = [np.array([middle, middle + min(mark, 0.3 * seam.length) * (along[where.middle] @ turn)])]
    length = np.linalg.norm(np.diff(points, axis=0), axis=1)
    edge = int(np.argmax(length * np.r_[0.5, np.ones(len(length) - 2), 0.5] if len(length) > 2 else length))
    text, inward = f"{seam.number}/{mate}", along[edge] @ turn
    size = float(min(height, 0.25 * seam.length, length[edge] / (LETTER_WIDTH * len(text))))
    # Beyond a mark at the middle.
    away = clearance(text, size, inward) + (mark if where.middle == edge else 0.0)
    return ticks, Text("SEAM", text, 0.5 * (points[edge] + points[edge + 1]) + away * inward, size)


def _unit(vectors: FloatArray) -> FloatArray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), np.finfo(float).tiny)
