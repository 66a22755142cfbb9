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
from .front_view import all_views
from .front_view import is_plan
from .front_view import seen_from
from .front_view import view_name
from .front_view import views_of
from .leaders import LED_SIZES
from .leaders import READABLE
from .leaders import around
from .leaders import led_aside
from .leaders import sides_of
from .leaders import towards
from .legend import curvature_notes
from .legend import key_of_plan
from .legend import with_legend
from .patterns import Patterns
from .patterns import refuse_others
from .picture_key import key_of
from .sheet_drawing import MARK_LENGTH

__all__ = ["courses", "draw_plan", "neighbours", "numbered_courses"]

SEAM_PLACES = (0.2, 0.8, 0.35, 0.65, 0.1, 0.9, 0.5)  # along a seam, where its number is tried, away from names in the middle of pieces
NAME_SHARES = (0.55, 0.9)  # height of a name relative to the room of its piece: usually, and at most where names would be unreadable
SEAM_SIZES = np.array([1.0, 0.7, 0.5])  # heights of the number of a seam that are tried, relative to the usual one
VIEW_GAP = 4.0  # between views, relative to the height of the texts
SUPPORT_SIZE = 0.3  # of the triangle at a support, relative to the height of the texts
SEAM_TEXT = 0.15  # height of the number of a seam, relative to its length in plan
MEANINGS = {
    "OUTLINE": "edges of the pieces",
    "LABEL": "name of the piece (A1 in region 0, B1 in region 1 and so on, or as the panel of the moulds), and in brackets its course: 1 "
    "for pieces on supports, or for the lowest piece of a part without supports, 2 for their neighbours, and so on; with a line "
    "to narrow pieces",
    "SEAM": "number of the seam, as on the sheets; beside the seam, or joined by a line to a short one",
    "MARK": "triangle with its tip at a supported point",
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
    held = _held(patterns)
    count = len(patterns.pieces)
    stands = np.bincount(own.piece, held[own.faces].any(axis=1), count) > 0
    lowest = np.full(count, np.inf)
    np.minimum.at(lowest, own.piece, own.space[own.faces][..., 2].min(axis=1))
    return numbered_courses(stands, lowest, neighbours(patterns))


def _held(patterns: Patterns) -> Mask:
    """Return the mask of nodes on supports."""
    return np.isin(patterns.patchwork.names, patterns.problem.names.vertices[patterns.problem.supports])


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
        View from above with elevations of steep pieces, or of an upright surface the view from outside [L].

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
    own, units, views = patterns.patchwork, patterns.problem.drawing.units, all_views(patterns.problem)
    corners = own.space[own.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    shown = views_of(views, normals, own.piece, len(patterns.pieces))
    height = 1.5 * MARK_LENGTH * float(np.ptp(own.space @ views[0, :2].T, axis=0).max())
    numbers, used = courses(patterns), np.unique(shown)
    drawn = _beside_the_first([_view(patterns, views[k], np.flatnonzero(shown == k), numbers, height) for k in used], VIEW_GAP * height)
    first = views[used[0]]
    low = np.min([own.space[loop.nodes].min(axis=0) for k in np.flatnonzero(shown == used[0]) for loop in patterns.pieces[k].loops], axis=0)
    origin = ", ".join(f"{axis} = {in_mm([value], units)}" for axis, value in zip("xy", low.tolist()))
    corner = f"; the lower left corner of this plan lies at {origin} of the model" if is_plan(first) else ""
    notes = [
        f"drawn 1:1, {seen_from(first)}{corner}",
        "pieces are rotated on their sheets; the numbers of their seams show the rotation",
        "heights: see the pieces in place, in the separate file -o NAME.3dm",
    ]
    if len(used) > 1:
        notes.append("steep pieces are drawn in the elevation from the side to which they face instead of in the plan")
    top, key = np.array([0.0, drawn.size[1] + 5.0 * height]), key_of(patterns.problem)
    notes += curvature_notes(key)
    lines, texts = key_of_plan(key, top, drawn.size[0], 0.75 * height, units, first)
    return with_legend(drawn._replace(lines=[*drawn.lines, *lines], texts=[*drawn.texts, *texts]), MEANINGS, notes, 0.75 * height)


def _beside_the_first(views: list[Drawing], gap: float) -> Drawing:
    """Return views with the others in a column to the right of the first, from the top, with a gap for their titles [L]."""
    found, right, bottom = views[0], views[0].size[0] + gap, 0.0
    for view in reversed(views[1:]):
        placed = view.moved((right, bottom))
        size = max(found.size[0], right + view.size[0]), max(found.size[1], bottom + view.size[1])
        bottom += view.size[1] + gap
        found = found._replace(lines=[*found.lines, *placed.lines], texts=[*found.texts, *placed.texts], size=size)
    return found


def _view(patterns: Patterns, axes: FloatArray, chosen: IntArray, numbers: list[int], height: float) -> Drawing:
    """Return the outlines, names and seam numbers of some pieces in a view, with its title above."""
    own = patterns.patchwork
    plan = own.space @ axes[:2].T
    corners = np.concatenate([plan[loop.nodes] for number in chosen for loop in patterns.pieces[number].loops])
    low = corners.min(axis=0)
    plan, size = plan - low, corners.max(axis=0) - low
    lines, texts = list[Line](), dict[int, Text]()
    for number in chosen.tolist():
        piece = patterns.pieces[number]
        loops = [plan[loop.nodes] for loop in piece.loops]
        lines += [Line("OUTLINE", loop, True) for loop in loops]
        # Pieces along the line of sight have no area.
        free, name = inside(loops), f"{piece.label} ({numbers[number]})"
        place, room = roomiest(free if len(free) else plan[own.faces[own.piece == number]].mean(axis=1), loops, name)
        texts[number] = Text("LABEL", name, place, float(min(height, np.clip(READABLE * height, *(np.array(NAME_SHARES) * room)))))
    middles = {number: text.place for number, text in texts.items()}
    sides = sides_of([line.points for line in lines])
    usual = 0.4 * height
    boxes = [text_box(own.text, own.place, own.height) for own in texts.values() if own.height >= READABLE * height]
    used = np.unique(own.faces[np.isin(own.piece, chosen)])
    supports = [_support(point, 0.5 * size, SUPPORT_SIZE * height) for point in plan[used[_held(patterns)[used]]]]
    lines += [Line("MARK", triangle, True) for triangle in supports]
    boxes += [np.array([triangle.min(axis=0), triangle.max(axis=0)]) for triangle in supports]
    for number, label in texts.items():
        if label.height < READABLE * height:
            places = around(label.place, label.text, READABLE * height, size)
            leader, texts[number] = led_aside(label, label.place, places, height * LED_SIZES[-1:], sides, boxes)
            boxes.append(text_box(label.text, texts[number].place, texts[number].height))
            lines += leader
    seams = [(seam, next((piece for piece in seam.pieces if piece in texts), None)) for seam in patterns.seams]
    beside = [(seam, piece, float(arc_lengths(plan[seam.nodes])[-1])) for seam, piece in seams if piece is not None]
    numbered = list[Text]()
    # Numbers of short seams are led to what room the others leave.
    for seam, piece, length in sorted(beside, key=lambda each: SEAM_TEXT * each[2] < READABLE * usual):
        text, small, leader = str(seam.number), min(usual, SEAM_TEXT * length), list[Line]()
        tried = [Text("SEAM", text, place, size) for size in small * SEAM_SIZES for place in _beside(plan[seam.nodes], text, size)]
        label = next((own for own in tried if not any(overlap(text_box(text, own.place, own.height), box) for box in boxes)), tried[0])
        if small < READABLE * usual:
            foot = point_at(plan[seam.nodes], np.array([0.5 * length]))[0]
            places = [*towards(foot, middles[piece]), *around(foot, text, float(usual * LED_SIZES[-1]), size)]
            leader, label = led_aside(label, foot, places, usual * LED_SIZES, sides, boxes)
        lines += leader
        numbered.append(label)
        boxes.append(text_box(text, label.place, label.height))
    name = view_name(axes, patterns.problem.drawing.north)
    every = len(chosen) == len(patterns.pieces)
    origin = "supports" if _held(patterns).any() else "lowest piece"
    about = f" with courses from the {origin} in brackets, and seam numbers" if every or is_plan(axes) else ""
    title = f"{name} of {len(chosen)} {'' if every or is_plan(axes) else 'steep '}pieces{about}"
    tall = height if about else min(height, float(size[0]) / (LETTER_WIDTH * len(title)))
    titled = Text("SHEET", title, np.array([0.5 * size[0], size[1] + 2.0 * height]), tall)
    return Drawing(lines, [*texts.values(), *numbered, titled], (float(size[0]), float(size[1])), patterns.problem.drawing.units)


def _support(tip: FloatArray, middle: FloatArray, size: float) -> FloatArray:
    """Return a triangle (3, 2) with its tip at a support, which points away from the middle of the view [L]."""
    inward = (middle - tip) / max(float(np.linalg.norm(middle - tip)), np.finfo(float).tiny)
    across = 0.5 * size * np.array([-inward[1], inward[0]])
    return np.array([tip, tip + size * inward + across, tip + size * inward - across])


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
