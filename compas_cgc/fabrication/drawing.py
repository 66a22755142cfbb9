"""Drawing of sheets: lines and texts by layer, which every format writes in its own way."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from .outlines import Loop
from .outlines import Seam
from .patchwork import EDGE
from .patterns import Patterns
from .patterns import Piece

__all__ = ["LAYERS", "Drawing", "Line", "Text", "draw_sheets"]

# Layers with their colours, red, green and blue.
LAYERS = {
    "SHEET": (150, 150, 150),
    "OUTLINE": (200, 30, 30),
    "FOLD_UP": (30, 80, 200),
    "FOLD_DOWN": (150, 40, 160),
    "RULING": (40, 150, 70),
    "MARK": (230, 140, 20),
    "LABEL": (30, 30, 30),
    "SEAM": (230, 140, 20),
    "NODE": (120, 120, 120),
}
GAP = 0.1  # between sheets, of a sheet's length
MARK = 0.012  # length of a mark, of a sheet's length
FOLD = np.radians(1.0)  # angle from which on an edge is drawn as a fold


class Line(NamedTuple):
    """A polyline."""

    layer: str
    points: FloatArray  # (k, 2) [L]
    closed: bool = False


class Text(NamedTuple):
    """A line of text, its middle at a place."""

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


def draw_sheets(patterns: Patterns, fold: float = FOLD, nodes: bool = True) -> Drawing:
    """Draw patterns: outlines, folds, rulings, marks, labels and node numbers of all sheets in a grid.

    Parameters
    ----------
    patterns
        What :func:`compas_cgc.fabrication.unroll` gave.
    fold
        Angle between two faces from which on their edge is drawn as a fold [rad].
    nodes
        Whether the nodes along outlines are numbered.

    Returns
    -------
    Drawing
        Lines and texts by layer, all sheets in a grid [L].

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import unroll
    >>> patterns = unroll(compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm"))), (3.0, 1.5))
    >>> sorted({line.layer for line in draw_sheets(patterns).lines})
    ['FOLD_DOWN', 'FOLD_UP', 'MARK', 'OUTLINE', 'RULING', 'SHEET']
    """
    length, width = patterns.sheet or _extent(patterns)
    step = (1.0 + GAP) * np.array([length, width])
    across = max(1, int(np.ceil(np.sqrt(patterns.sheets * width / length))))
    rows = -(-patterns.sheets // across)
    # The first sheet at the upper left.
    origins = np.array([[k % across, rows - 1 - k // across] for k in range(patterns.sheets)]) * step
    mark, height = MARK * length, 0.5 * MARK * length
    lines, texts = [], []
    for number, origin in enumerate(origins):
        if patterns.sheet is not None:
            corners = np.array([[0, 0], [length, 0], [length, width], [0, width]], dtype=np.float64)
            lines.append(Line("SHEET", corners + origin, True))
            texts.append(Text("SHEET", f"sheet {number + 1}", origin + [0.5 * length, width + 2.0 * height], 2.0 * height))
    names = patterns.patchwork.names
    for number, piece in enumerate(patterns.pieces):
        origin = origins[piece.sheet]
        lines += [Line("OUTLINE", loop.points + origin, True) for loop in piece.loops]
        lines += _fold_lines(patterns, number, fold, origin)
        place, room = _roomiest(patterns, number, piece)
        texts.append(Text("LABEL", piece.label, place + origin, float(min(4.0 * height, 0.6 * room))))
        if nodes:
            texts += [text for loop in piece.loops for text in _node_numbers(loop, names, height, origin)]
    for ruling in patterns.rulings:
        lines.append(Line("RULING", ruling.points + origins[patterns.pieces[ruling.piece].sheet]))
    for seam in patterns.seams:
        for side in (0, 1):
            origin = origins[patterns.pieces[seam.pieces[side]].sheet]
            mate = patterns.pieces[seam.pieces[1 - side]].label
            marks, text = _seam_marks(seam, side, mate, mark, height)
            lines += [Line("MARK", points + origin) for points in marks]
            texts.append(text._replace(place=text.place + origin))
    size = step * [across, rows] - [GAP * length, GAP * width]
    return Drawing(lines, texts, (float(size[0]), float(size[1])), patterns.problem.drawing.units)


def _extent(patterns: Patterns) -> tuple[float, float]:
    high = patterns.patchwork.plane.max(axis=(0, 1))
    return float(high[0]), float(high[1])


def _fold_lines(patterns: Patterns, piece: int, fold: float, origin: FloatArray) -> list[Line]:
    own = patterns.patchwork
    angle = np.where((own.piece == piece)[:, None] & (own.side == EDGE), patterns.folds, 0.0)
    # Either side of an edge says the same; one of them is drawn.
    u, v = own.faces, np.roll(own.faces, -1, axis=1)
    chosen = (np.abs(angle) >= fold) & (u < v)
    start, end = own.plane[chosen], np.roll(own.plane, -1, axis=1)[chosen]
    layers = np.where(angle[chosen] > 0, "FOLD_UP", "FOLD_DOWN")
    return [Line(str(layer), np.array([a, b]) + origin) for layer, a, b in zip(layers, start, end)]


def _roomiest(patterns: Patterns, number: int, piece: Piece) -> tuple[FloatArray, float]:
    """Return the middle of a face farthest from the outline of its piece, and how far that is [L]."""
    own = patterns.patchwork
    centres = own.plane[own.piece == number].mean(axis=1)
    centres = centres[:: max(1, len(centres) // 200)]
    start = np.concatenate([loop.points for loop in piece.loops])
    end = np.concatenate([np.roll(loop.points, -1, axis=0) for loop in piece.loops])
    along = end - start
    from_start = centres[:, None] - start
    share = np.einsum("pkj,kj->pk", from_start, along) / np.maximum(np.einsum("kj,kj->k", along, along), np.finfo(float).tiny)
    away = np.linalg.norm(from_start - np.clip(share, 0.0, 1.0)[..., None] * along, axis=2).min(axis=1)
    best = int(np.argmax(away))
    return centres[best], float(away[best])


def _node_numbers(loop: Loop, names: IntArray, height: float, origin: FloatArray) -> list[Text]:
    """Number the nodes of an outline, inside of it, as small as their distance asks for."""
    ahead, back = np.roll(loop.points, -1, axis=0) - loop.points, loop.points - np.roll(loop.points, 1, axis=0)
    near = np.minimum(np.linalg.norm(ahead, axis=1), np.linalg.norm(back, axis=1))
    inward = _unit(np.column_stack([-(ahead + back)[:, 1], (ahead + back)[:, 0]]))
    texts = []
    for node, point, direction, room in zip(names[loop.nodes].tolist(), loop.points, inward, near):
        size = float(min(0.7 * height, 0.3 * room))
        texts.append(Text("NODE", str(node), point + 2.0 * size * direction + origin, size))
    return texts


def _seam_marks(seam: Seam, side: int, mate: str, mark: float, height: float) -> tuple[list[FloatArray], Text]:
    """Return ticks at the same nodes on either side of a seam, and its number with the piece beyond, inside of this piece."""
    points = seam.sides[side]
    along = _unit(np.diff(points, axis=0))
    at_node = _unit(np.vstack([along[:1], along[1:] + along[:-1], along[-1:]]))
    inward = np.column_stack([-at_node[:, 1], at_node[:, 0]]) * (1.0 if side == 0 else -1.0)
    inner = np.arange(1, len(points) - 1)
    ticks = [np.array([points[k], points[k] + mark * inward[k]]) for k in inner[:: max(1, len(inner) // 8)]]
    length = np.linalg.norm(np.diff(points, axis=0), axis=1)
    middle = int(np.argmax(length * np.r_[0.5, np.ones(len(length) - 2), 0.5] if len(length) > 2 else length))
    across = np.array([-along[middle, 1], along[middle, 0]]) * (1.0 if side == 0 else -1.0)
    place = 0.5 * (points[middle] + points[middle + 1]) + 1.2 * mark * across
    size = float(min(height, 0.25 * seam.length))
    return ticks, Text("SEAM", f"{seam.number}/{mate}", place, size)


def _unit(vectors: FloatArray) -> FloatArray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), np.finfo(float).tiny)
