"""Assembly: neighbours of pieces, courses of erection, and a labelled plan."""

from __future__ import annotations

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
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
from .front_view import front_view
from .front_view import is_plan
from .front_view import seen_from
from .front_view import view_name
from .leaders import LED_SIZES
from .leaders import READABLE
from .leaders import around
from .leaders import led_aside
from .leaders import sides_of
from .leaders import towards
from .legend import key_of_plan
from .legend import with_legend
from .patterns import Patterns
from .patterns import refuse_others
from .picture_key import key_of
from .sheet_drawing import MARK_LENGTH

__all__ = ["courses", "draw_plan", "neighbours", "numbered_courses"]

SEAM_PLACES = (0.2, 0.8, 0.35, 0.65, 0.1, 0.9, 0.5)  # along a seam, where its number is tried, away from names in the middle of pieces
SEAM_TEXT = 0.15  # height of the number of a seam, relative to its length in plan
MEANINGS = {
    "OUTLINE": "edges of the pieces",
    "LABEL": "name of the piece (A1 in region 0, B1 in region 1 and so on, or as the panel of the moulds), and in brackets its course: 1 "
    "for pieces on supports, 2 for their neighbours, and so on; with a line to narrow pieces",
    "SEAM": "number of the seam, as on the sheets, beside it, or with a line to a short seam",
}


def neighbours(patterns: Patterns) -> list[list[int]]:
    """Return for every piece the numbers of the pieces that share a seam with it."""
    beside: list[set[int]] = [set() for _ in patterns.pieces]
    for one, other in (seam.pieces for seam in patterns.seams):
        if one != other:
            beside[one].add(other)
            beside[other].add(one)
    return [sorted(own) for own in beside]


def courses(patterns: Patterns) -> list[int]:
    """Return the course of every piece: 1 for pieces on supports, 2 for their neighbours, and so on.

    In a connected part without supports the lowest piece has course 1.
    """
    own = patterns.patchwork
    held = np.isin(own.names, patterns.problem.names.vertices[patterns.problem.supports])
    count = len(patterns.pieces)
    stands = np.bincount(own.piece, held[own.faces].any(axis=1), count) > 0
    lowest = np.full(count, np.inf)
    np.minimum.at(lowest, own.piece, own.space[own.faces][..., 2].min(axis=1))
    return numbered_courses(stands, lowest, neighbours(patterns))


def numbered_courses(stands: Mask, lowest: FloatArray, beside: list[list[int]]) -> list[int]:
    """Return the course of every part: 1 for parts that stand on supports, 2 for their neighbours, and so on.

    Parameters
    ----------
    stands
        ``(n,)`` whether a part has supports.
    lowest
        ``(n,)`` height of its lowest point, by which a part is chosen where none has supports [L].
    beside
        Neighbours of every part.
    """
    found = np.zeros(len(beside), np.int64)
    front = np.flatnonzero(stands).tolist()
    while (found == 0).any():
        if not front:
            front = [int(np.argmin(np.where(found == 0, lowest, np.inf)))]
        front = _numbered(found, front, beside)
    return found.tolist()


def _numbered(found: IntArray, front: list[int], beside: list[list[int]]) -> list[int]:
    """Assign courses in place to a front of pieces and all that are connected to it; return the empty front."""
    course = 1
    while front:
        found[front] = course
        front = sorted({near for piece in front for near in beside[piece] if found[near] == 0})
        course += 1
    return front


@names_what_was_meant()
def draw_plan(patterns: Patterns) -> Drawing:
    """Return a plan of the surface with the outlines, names and courses of the pieces and the seam numbers.

    Parameters
    ----------
    patterns
        Result of :func:`compas_cgc.fabrication.unroll`.

    Returns
    -------
    Drawing
        View from above, or of an upright surface from outside [L]; pieces along the line of sight appear as lines.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import unroll
    >>> patterns = unroll(compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm"))), (3.0, 1.5))
    >>> [text.text for text in draw_plan(patterns).texts if text.layer == "LABEL"][0]
    'A1 (1)'
    >>> sum(text.layer == "LABEL" for text in draw_plan(patterns).texts) == len(patterns.pieces)
    True
    """
    refuse_others(patterns, "a plan is drawn", "draw_plan")
    own = patterns.patchwork
    axes = front_view(patterns.problem)
    plan = own.space @ axes[:2].T
    low, high = plan.min(axis=0), plan.max(axis=0)
    plan = plan - low
    size = (float(high[0] - low[0]), float(high[1] - low[1]))
    height = 1.5 * MARK_LENGTH * max(size)
    lines, texts = [], []
    for number, (piece, course) in enumerate(zip(patterns.pieces, courses(patterns))):
        loops = [plan[loop.nodes] for loop in piece.loops]
        lines += [Line("OUTLINE", loop, True) for loop in loops]
        # Pieces along the line of sight have no area.
        free = inside(loops)
        place, room = roomiest(free if len(free) else plan[own.faces[own.piece == number]].mean(axis=1), loops)
        name = f"{piece.label} ({course})"
        texts.append(Text("LABEL", name, place, float(min(height, 2.0 * room / (LETTER_WIDTH * len(name))))))
    middles = [own.place for own in texts]
    sides = sides_of([line.points for line in lines])
    usual = 0.4 * height
    boxes = [text_box(own.text, own.place, own.height) for own in texts if own.height >= READABLE * height]
    for k, label in enumerate(texts):
        if label.height < READABLE * height:
            leader, texts[k] = led_aside(
                label,
                label.place,
                around(label.place, label.text, READABLE * height, np.array(size)),
                height * LED_SIZES[-1:],
                sides,
                boxes,
            )
            boxes.append(text_box(label.text, texts[k].place, texts[k].height))
            lines += leader
    lengths = [float(arc_lengths(plan[seam.nodes])[-1]) for seam in patterns.seams]
    # Numbers of short seams are led to what room the others leave.
    for length, seam in sorted(zip(lengths, patterns.seams), key=lambda each: SEAM_TEXT * each[0] < READABLE * usual):
        text, small, leader = str(seam.number), min(usual, SEAM_TEXT * length), list[Line]()
        places = _beside(plan[seam.nodes], text, small)
        place = next((own for own in places if not any(overlap(text_box(text, own, small), box) for box in boxes)), places[0])
        label = Text("SEAM", text, place, small)
        if small < READABLE * usual:
            foot = point_at(plan[seam.nodes], np.array([0.5 * length]))[0]
            leader, label = led_aside(label, foot, towards(foot, middles[seam.pieces[0]]), usual * LED_SIZES, sides, boxes)
        lines += leader
        texts.append(label)
        boxes.append(text_box(text, label.place, label.height))
    title = f"{view_name(axes)} of {len(patterns.pieces)} pieces with courses from the supports in brackets, and seam numbers"
    texts.append(Text("SHEET", title, np.array([0.5 * size[0], size[1] + 2.0 * height]), height))
    units = patterns.problem.drawing.units
    origin = ", ".join(f"{axis} = {in_mm([value], units)}" for axis, value in zip("xy", low.tolist()))
    corner = f"; the lower left corner of this plan lies at {origin} of the model" if is_plan(axes) else ""
    notes = [
        f"drawn 1:1, {seen_from(axes)}{corner}",
        "pieces lie on their sheets turned; the numbers of seams show how",
    ]
    key = key_of_plan(key_of(patterns.problem), np.array([0.0, size[1] + 5.0 * height]), size[0], 0.75 * height, units, axes)
    return with_legend(Drawing([*lines, *key[0]], [*texts, *key[1]], size, units), MEANINGS, notes, 0.75 * height)


def _beside(path: FloatArray, text: str, size: float) -> list[FloatArray]:
    """Return the places (2,) beside a path (k, 2) at which its text is tried, in order [L]."""
    at = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))]
    found = []
    for station in at[-1] * np.array(SEAM_PLACES):
        edge = min(int(np.searchsorted(at, station, side="right")), len(path) - 1) - 1
        ahead = (path[edge + 1] - path[edge]) / max(at[edge + 1] - at[edge], np.finfo(float).tiny)
        foot = path[edge] + (station - at[edge]) * ahead
        aside = np.array([-ahead[1], ahead[0]])
        found += [foot + side * clearance(text, size, aside) * aside for side in (1.0, -1.0)]
    return found
