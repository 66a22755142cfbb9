"""Assembly: neighbours of pieces, courses of erection, and a labelled plan."""

from __future__ import annotations

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..errors import names_what_was_meant
from .drawing import LETTER_WIDTH
from .drawing import Drawing
from .drawing import Line
from .drawing import Text
from .drawing import clearance
from .drawing import roomiest
from .figures import in_mm
from .legend import with_legend
from .patterns import Patterns
from .patterns import refuse_others
from .sheet_drawing import MARK_LENGTH

__all__ = ["courses", "draw_plan", "neighbours", "numbered_courses"]

MEANINGS = {
    "OUTLINE": "edges of the pieces",
    "LABEL": "name of the piece, and in brackets its course: 1 for pieces on supports, 2 for their neighbours, and so on",
    "SEAM": "number of the seam, as on the sheets",
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
        View from above [L]; vertical pieces appear as lines.

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
    low, high = own.space[:, :2].min(axis=0), own.space[:, :2].max(axis=0)
    plan = own.space[:, :2] - low
    size = (float(high[0] - low[0]), float(high[1] - low[1]))
    height = 1.5 * MARK_LENGTH * max(size)
    lines, texts = [], []
    for number, (piece, course) in enumerate(zip(patterns.pieces, courses(patterns))):
        loops = [plan[loop.nodes] for loop in piece.loops]
        lines += [Line("OUTLINE", loop, True) for loop in loops]
        place, room = roomiest(plan[own.faces[own.piece == number]].mean(axis=1), loops)
        name = f"{piece.label} ({course})"
        texts.append(Text("LABEL", name, place, float(min(height, 2.0 * room / (LETTER_WIDTH * len(name))))))
    for seam in patterns.seams:
        along = plan[seam.nodes]
        length = np.linalg.norm(np.diff(along, axis=0), axis=1)
        edge = int(np.argmax(length))
        ahead = (along[edge + 1] - along[edge]) / max(length[edge], np.finfo(float).tiny)
        aside, text, small = np.array([-ahead[1], ahead[0]]), str(seam.number), float(min(0.5 * height, 0.5 * length[edge]))
        texts.append(Text("SEAM", text, 0.5 * (along[edge] + along[edge + 1]) + clearance(text, small, aside) * aside, small))
    title = f"plan of {len(patterns.pieces)} pieces with courses from the supports in brackets, and seam numbers"
    texts.append(Text("SHEET", title, np.array([0.5 * size[0], size[1] + 2.0 * height]), height))
    units = patterns.problem.drawing.units
    origin = ", ".join(f"{axis} = {in_mm([value], units)}" for axis, value in zip("xy", low.tolist()))
    notes = [
        f"drawn 1:1, seen from above, x to the right and y up; the lower left corner of this plan lies at {origin} of the model",
        "pieces lie on their sheets turned; the numbers of seams show how",
    ]
    return with_legend(Drawing(lines, texts, size, units), MEANINGS, notes, 0.75 * height)
