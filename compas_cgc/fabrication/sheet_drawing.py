"""Drawing of patterns on sheets: contours, folds, rulings, marks, numbers, titles and the legend."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..errors import CGCError
from ..errors import names_what_was_meant
from ..meshing.polyline import arc_lengths
from ..meshing.polyline import point_at
from .drawing import LETTER_WIDTH
from .drawing import Drawing
from .drawing import Line
from .drawing import Text
from .drawing import clearance
from .drawing import inside
from .drawing import overlap
from .drawing import roomiest
from .drawing import text_box
from .figures import in_mm
from .figures import metres
from .leaders import LED_SIZES
from .leaders import READABLE
from .leaders import crosses
from .leaders import is_free
from .leaders import led_aside
from .leaders import sides_of
from .leaders import towards
from .legend import curvature_notes
from .legend import key_of_plan
from .legend import outside_is_above
from .legend import outside_note
from .legend import with_legend
from .outlines import Loop
from .outlines import Seam
from .patchwork import EDGE
from .patterns import Patterns
from .patterns import refuse_others
from .picture_key import Key
from .picture_key import key_of
from .piece_checks import at_sheet_edge
from .piece_checks import contours
from .piece_checks import remarks
from .rulings import MAX_BOW
from .rulings import Ruling

__all__ = ["MARK_LENGTH", "draw_sheets", "folded", "rolled_regions"]

SHEET_GAP = 0.1  # between sheets, relative to the sheet length
MEANINGS = {
    "CUT": "contour to cut",
    "OUTLINE": "edge of the piece where it meets its neighbours; not cut",
    "FOLD_UP": "fold line, engraved; ridge towards the viewer, both sides bend away",
    "FOLD_DOWN": "fold line, engraved; valley, both sides bend towards the viewer",
    "RULING": "line along the piece that stays straight, across which it is rolled; to engrave or draw with its text, not to cut; R: "
    "bending radius in mm at the middle of the line; away: the piece beside the line bends away from the viewer, towards: to the viewer",
    "MARK": "tick to engrave; it lies against the tick of the same seam on the neighbouring piece, or where two seams meet on a straight "
    "side, against the corner between the two neighbours",
    "LABEL": "name of the piece, to engrave",
    "SEAM": "number of the seam / name of the piece beyond it, to engrave, with a line where there is no room beside the seam; sides "
    "without one are edges of the roof",
    "NODE": "number of the node, where there is room, as in the edge table (the separate file -o NAME.csv); not engraved",
    "SHEET": "edge of the sheet and its title; not cut",
}
CHORDS = "cut as drawn, straight from point to point, not as a smooth curve: both pieces at a seam have the same points"
MARK_LENGTH = 0.012  # relative to the sheet length
MAX_JOINT_TURN = np.radians(30.0)  # of an outline at a joint of two seams that gets a tick; larger ones are corners
MIN_FOLD = np.radians(1.0)  # least angle of an edge that is drawn as a fold
TEXT_SIZES = np.array([0.7, 0.5, 0.35, 0.25])  # heights of the texts at rulings, relative to the text height, the first that fits
PLACES = (0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8)  # along a ruling, where its text is tried in this order
MIN_NUMBER_SIZE = 0.2  # relative to the text height; smaller node numbers are omitted


@names_what_was_meant()
def draw_sheets(patterns: Patterns, fold: float = MIN_FOLD, nodes: bool = True, sheet: Optional[int] = None) -> Drawing:
    """Return a drawing of patterns with outlines, allowances, folds, rulings, marks, labels, node numbers and a legend.

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
    ['CUT', 'LEGEND', 'MARK', 'RULING', 'SEAM', 'SHEET']
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
            title = _title(patterns, number)
            tall = min(2.0 * height, x / (LETTER_WIDTH * len(title)))
            texts.append(Text("SHEET", title, origin + [0.5 * x, y + 2.0 * height], tall))
    names, is_fold = patterns.patchwork.names, folded(patterns, fold)
    joints = _joint_ticks(patterns, mark)
    ticked = [set(own) for own in joints]
    for seam in patterns.seams:
        for side in seam.pieces:
            ticked[side].update(seam.nodes[_marks_of(seam, mark).nodes].tolist())
    labels = np.zeros((len(patterns.pieces), 2, 2))
    for number, piece in enumerate(patterns.pieces):
        if piece.sheet not in origins:
            continue
        origin = origins[piece.sheet]
        # With an allowance the outline is where pieces meet, not where they are cut.
        lines += [Line("CUT", points + origin, True) for points in contours(piece)]
        lines += [Line("OUTLINE", loop.points + origin, True) for loop in (piece.loops if piece.allowance else [])]
        lines += _fold_lines(patterns, number, is_fold, origin)
        loops = [loop.points for loop in piece.loops]
        free = inside(loops)
        # Needles may lie between the points of the grid.
        centres = free if len(free) else patterns.patchwork.plane[patterns.patchwork.piece == number].mean(axis=1)
        place, room = roomiest(centres, loops, piece.label)
        label = Text("LABEL", piece.label, place + origin, min(4.0 * height, 0.8 * room))
        texts.append(label)
        labels[number] = text_box(piece.label, place, label.height)
    taken = [[own] for own in labels]
    for ruling in patterns.rulings:
        if patterns.pieces[ruling.piece].sheet in origins:
            origin = origins[patterns.pieces[ruling.piece].sheet]
            lines.append(Line("RULING", ruling.points + origin))
            texts += _radius(patterns, ruling, height, origin, taken[ruling.piece])
    drawn_seams = _drawn_seams(patterns, origins, labels, taken, joints, mark, height)
    lines, texts = [*lines, *drawn_seams[0]], [*texts, *drawn_seams[1]]
    for number, piece in enumerate(patterns.pieces):
        if nodes and piece.sheet in origins:
            numbers = [text for loop in piece.loops for text in _node_numbers(loop, names, ticked[number], mark, height)]
            # Nodes give way to all other texts.
            clear = [own for own in numbers if not any(overlap(text_box(own.text, own.place, own.height), box) for box in taken[number])]
            texts += [own._replace(place=own.place + origins[piece.sheet]) for own in clear]
    size = step * [across, rows] - [SHEET_GAP * length, SHEET_GAP * width]
    units = patterns.problem.drawing.units
    words = (*key_of(patterns.problem).words, "the plan of the pieces shows where each piece lies on the roof, and north")
    drawn_key = key_of_plan(Key("", None, words), np.array([0.0, size[1] + 6.0 * height]), length, 1.5 * height, units)
    lines, texts = [*lines, *drawn_key[0]], [*texts, *drawn_key[1]]
    drawing = Drawing(lines, texts, (float(size[0]), float(size[1])), units)
    return with_legend(drawing, {**MEANINGS, "CUT": f"{_cut(patterns)}; {CHORDS}"}, _notes(patterns), 1.5 * height, length)


def _drawn_seams(
    patterns: Patterns,
    origins: Mapping[int, FloatArray],
    labels: FloatArray,
    taken: list[list[FloatArray]],
    joints: list[dict[int, FloatArray]],
    mark: float,
    height: float,
) -> tuple[list[Line], list[Text]]:
    """Return the ticks of seams on drawn sheets, and the numbers of seams where there is room.

    Parameters
    ----------
    patterns
        The pieces.
    origins
        ``(2,)`` lower left corners of the drawn sheets [L].
    labels
        ``(p, 2, 2)`` boxes of the names of pieces [L].
    taken
        Boxes of texts by piece, to which those of the numbers are added [L].
    joints
        ``(2, 2)`` ticks at joints of seams by node, of every piece [L].
    mark, height
        Length of ticks and height of texts [L].
    """
    lines, texts, numbers = list[Line](), list[Text](), list[tuple[int, Seam, int, Text]]()
    segments = [sides_of([loop.points for loop in piece.loops]) for piece in patterns.pieces]
    for number, (piece, own) in enumerate(zip(patterns.pieces, joints)):
        if own and piece.sheet in origins:
            segments[number] = np.concatenate([segments[number], list(own.values())])
            lines += [Line("MARK", points + origins[piece.sheet]) for points in own.values()]
    for seam in patterns.seams:
        for side, number in enumerate(seam.pieces):
            if patterns.pieces[number].sheet not in origins:
                continue
            mate = patterns.pieces[seam.pieces[1 - side]].label
            marks, text = _seam_marks(seam, side, mate, mark, height)
            segments[number] = np.concatenate([segments[number], marks])
            lines += [Line("MARK", points + origins[patterns.pieces[number].sheet]) for points in marks]
            numbers.append((number, seam, side, text))
    # Long seams keep their usual places, and short ones take what room is left.
    for number, seam, side, text in sorted(numbers, key=lambda each: -each[1].length):
        piece, leader, sides = patterns.pieces[number], list[Line](), segments[number]
        if text.height < READABLE * height or not is_free(text_box(text.text, text.place, text.height), sides, taken[number]):
            foot, middle = point_at(seam.sides[side], 0.5 * arc_lengths(seam.sides[side])[-1:])[0], labels[number].mean(axis=0)
            grid = inside([loop.points for loop in piece.loops])
            near = grid[np.argsort(np.linalg.norm(grid - foot, axis=1), kind="stable")]
            leader, text = led_aside(text, foot, [*towards(foot, middle), *near], height * LED_SIZES, sides, taken[number])
        taken[number].append(text_box(text.text, text.place, text.height))
        lines += [own._replace(points=own.points + origins[piece.sheet]) for own in leader]
        texts.append(text._replace(place=text.place + origins[piece.sheet]))
    return lines, texts


def _title(patterns: Patterns, number: int) -> str:
    """Return the title of a sheet: number, size, material, pieces, what cut lines are, and the pieces on its edge."""
    size = in_mm(patterns.sheet_sizes[number], patterns.problem.drawing.units)
    stuff = f", {patterns.stock.stuff}" if patterns.stock.stuff else ""
    own = [piece for piece in patterns.pieces if piece.sheet == number]
    edge = ", ".join(piece.label for piece in own if at_sheet_edge(patterns, piece))
    on_edge = f"; not trimmed, on the edge of the sheet: {edge}" if edge else ""
    labels = ", ".join(piece.label for piece in own)
    return f"sheet {number + 1} of {patterns.sheets}, {size}{stuff}: {labels}; seen from outside; CUT: {_cut(patterns)}{on_edge}"


def _cut(patterns: Patterns) -> str:
    """Return what cut lines are."""
    units, stock = patterns.problem.drawing.units, patterns.stock
    cut = f"middle of a kerf of {in_mm([stock.kerf], units)}" if stock.kerf else "edge, without kerf"
    return f"{cut}{f', with an allowance of {in_mm([stock.allowance], units)} all around' if stock.allowance else ''}"


def _notes(patterns: Patterns) -> list[str]:
    """Return the sentences of the legend that hold for all sheets."""
    stuff = patterns.stock.stuff
    notes = [
        f"material: {stuff}" if stuff else "material and thickness are not given",
        "drawn 1:1; lengths in texts are in mm; pieces are seen from outside, with the size of the surface at the middle of the thickness",
        outside_note(outside_is_above(face_normals(patterns.problem.vertices, patterns.problem.faces))),
        "engraving lies on the outside; mirror the sheets to engrave the inside",
        "pieces meet edge to edge: no gap is left at seams, and no holes, fixings or tolerances are included",
        patterns.free,
        *curvature_notes(key_of(patterns.problem)),
    ]
    if patterns.stock.grain is not None:
        notes.append("the grain runs along the length of the sheets")
    if folded(patterns).any():
        notes.append(
            f"folds are edges of the triangles of the model; they end where the angle is less than {np.degrees(MIN_FOLD):g} degree; the "
            "edge table (the separate file -o NAME.csv) holds the angles"
        )
    else:
        notes.append("there are no folds: pieces are rolled or pressed; the cut list holds their radii, strains and moulds")
    if patterns.rulings:
        off = [own for own in patterns.straightness.values() if own.median <= MAX_BOW]
        notes.append(
            f"rulings deviate from straight lines by {100 * max(own.median for own in off):.2g} % of their length (median); "
            "if there is no room for the radius of a ruling, see the cut list; a piece without rulings in a region with rulings is bent as "
            "well, by hand until its seams meet those of its neighbours, as no radius is known"
        )
    return [*notes, *remarks(patterns)]


def _radius(patterns: Patterns, ruling: Ruling, height: float, origin: FloatArray, taken: list[FloatArray]) -> list[Text]:
    """Return the radius of bending at the middle of a ruling, beside it and inside the piece; nothing where no place is free.

    `taken` holds the boxes of texts in the piece, to which the box of this text is added.
    """
    radius = 1e3 * metres(patterns.problem.drawing.units) / abs(ruling.bending) if ruling.bending else np.inf
    text = f"R {radius:.0f} {'away' if ruling.bending > 0.0 else 'towards'}" if np.isfinite(radius) else "flat"
    loops = [loop.points for loop in patterns.pieces[ruling.piece].loops]
    sides = sides_of(loops)
    length = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(ruling.points, axis=0), axis=1))]
    for size in height * TEXT_SIZES:
        for share in PLACES:
            k = min(max(1, int(np.searchsorted(length, share * length[-1]))), len(length) - 1)
            along = _unit((ruling.points[k] - ruling.points[k - 1])[None])[0]
            foot = ruling.points[k - 1] + (share * length[-1] - length[k - 1]) * along
            for aside in (np.array([-along[1], along[0]]), np.array([along[1], -along[0]])):
                place = foot + clearance(text, size, aside) * aside
                box = text_box(text, place, size)
                whole = np.array([np.minimum(box[0], foot), np.maximum(box[1], foot)])
                if not crosses(sides, whole).any() and not any(overlap(box, other) for other in taken):
                    taken.append(box)
                    return [Text("RULING", text, place + origin, float(size))]
    return []


def folded(patterns: Patterns, fold: float = MIN_FOLD) -> Mask:
    """Return the mask of face sides (m, 3) folded by at least an angle; rolled and pressed pieces have none."""
    rolled = rolled_regions(patterns)
    flat = [own.region for own in patterns.unrollings if own.unrolled and own.region not in rolled]
    return np.isin(patterns.patchwork.region, flat)[:, None] & (np.abs(patterns.folds) >= fold)


def rolled_regions(patterns: Patterns) -> set[int]:
    """Return the regions that are rolled across straight rulings."""
    return {region for region, own in patterns.straightness.items() if own.median <= MAX_BOW}


def _extent(patterns: Patterns) -> tuple[float, float]:
    """Return the length and width of the pieces with allowances, used for an unlimited sheet [L]."""
    edges = [loop for piece in patterns.pieces for loop in piece.allowance or [own.points for own in piece.loops]]
    high = np.concatenate(edges).max(axis=0) + patterns.stock.margin
    return float(high[0]), float(high[1])


def _fold_lines(patterns: Patterns, piece: int, is_fold: Mask, origin: FloatArray) -> list[Line]:
    own = patterns.patchwork
    # Both sides of an edge have the same angle; draw one.
    u, v = own.faces, np.roll(own.faces, -1, axis=1)
    chosen = (own.piece == piece)[:, None] & (own.side == EDGE) & is_fold & (u < v)
    start, end = own.plane[chosen], np.roll(own.plane, -1, axis=1)[chosen]
    layers = np.where(patterns.folds[chosen] > 0, "FOLD_UP", "FOLD_DOWN")
    return [Line(str(layer), np.array([a, b]) + origin) for layer, a, b in zip(layers, start, end)]


def _node_numbers(loop: Loop, names: IntArray, ticked: set[int], mark: float, height: float) -> list[Text]:
    """Return the node numbers of an outline, inside it and its marks, without those too small to read."""
    ahead, back = np.roll(loop.points, -1, axis=0) - loop.points, loop.points - np.roll(loop.points, 1, axis=0)
    near = np.minimum(np.linalg.norm(ahead, axis=1), np.linalg.norm(back, axis=1))
    inward = _inward(loop.points)
    # Along a bisector the distance to the sides is shorter.
    slant = np.clip(np.abs(np.einsum("ij,ij->i", inward, np.column_stack([-_unit(ahead)[:, 1], _unit(ahead)[:, 0]]))), 0.3, 1.0)
    texts = []
    for node, point, direction, room, share in zip(loop.nodes.tolist(), loop.points, inward, near, slant.tolist()):
        size = float(min(0.7 * height, 0.3 * room))
        if size >= MIN_NUMBER_SIZE * height:
            text = str(names[node])
            away = clearance(text, size, direction) / share + (mark if node in ticked else 0.0)
            texts.append(Text("NODE", text, point + away * direction, size))
    return texts


def _joint_ticks(patterns: Patterns, mark: float) -> list[dict[int, FloatArray]]:
    """Return the ticks (2, 2) at the nodes of every piece where two of its seams meet and its outline has no corner [L]."""
    ends: list[list[int]] = [[] for _ in patterns.pieces]
    for seam in patterns.seams:
        for number in seam.pieces:
            ends[number] += seam.nodes[[0, -1]].tolist()
    found = list[dict[int, FloatArray]]()
    for piece, own in zip(patterns.pieces, ends):
        nodes, counts = np.unique(np.array(own, dtype=np.int64), return_counts=True)
        ticks = dict[int, FloatArray]()
        for loop in piece.loops:
            ahead = _unit(np.roll(loop.points, -1, axis=0) - loop.points)
            straight = (ahead * np.roll(ahead, 1, axis=0)).sum(axis=1) > np.cos(MAX_JOINT_TURN)
            inward = _inward(loop.points)
            for k in np.flatnonzero(straight & np.isin(loop.nodes, nodes[counts > 1])).tolist():
                ticks[int(loop.nodes[k])] = np.array([loop.points[k], loop.points[k] + mark * inward[k]])
        found.append(ticks)
    return found


def _inward(points: FloatArray) -> FloatArray:
    """Return the unit bisectors (k, 2) at the points (k, 2) of an outline, to the left of it."""
    ahead = _unit(np.roll(points, -1, axis=0) - points)
    x, y = (ahead + np.roll(ahead, 1, axis=0)).T
    return _unit(np.column_stack([-y, x]))


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
