"""Edge table of patterns as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from collections.abc import Sequence

import numpy as np

from .figures import metres
from .patchwork import EDGE
from .patchwork import NONE
from .patchwork import SIDES
from .patchwork import mates
from .patchwork import outline_sides
from .patterns import Patterns
from .sheet_drawing import folded

__all__ = ["csv_text", "edge_table", "edge_table_text", "escaped", "unescaped"]

_FORMULA_MARKS = frozenset("=+-@\t\r")  # first characters of formulas in spreadsheets
NOTES = (
    "from, to: numbers of the nodes, as on the sheets; lengths are exact, without rounding to a tolerance",
    "kind: fold: folded edge within a piece; inner: edge within a piece that is only rolled or pressed; cut, seam: joint with the adjacent "
    "piece; crease: joint with a kink; edge: edge of the roof",
    "angle: between the two triangles of the model along the edge, positive if convex seen from outside; 0 along outlines",
)
_HEAD = ("piece", "from", "to", "kind", "length in space in mm", "length in plane in mm", "angle in degrees", "seam", "beyond")


def csv_text(head: Sequence[str], rows: Iterable[Sequence[object]], notes: Sequence[str] = ()) -> str:
    """Return a table as CSV; notes on the whole table follow in rows of their own, in a last column that is empty in all other rows."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    lines: list[Sequence[object]] = [[*head, "notes"] if notes else head]
    lines += [[*row, ""] if notes else row for row in rows]
    lines += [[*("" for _ in head), note] for note in notes]
    writer.writerows([escaped(value) for value in line] for line in lines)
    return text.getvalue()


def escaped(value: object) -> object:
    """Return a cell that spreadsheets do not run as a formula; such texts get a leading apostrophe."""
    return f"'{value}" if isinstance(value, str) and _runs(value) else value


def unescaped(text: str) -> str:
    """Return the text of a cell that :func:`escaped` wrote."""
    return text[1:] if text[:1] == "'" and _runs(text[1:]) else text


def _runs(text: str) -> bool:
    if text[:1] not in _FORMULA_MARKS:
        return False
    try:
        float(text)
    except ValueError:
        return True
    return False


def edge_table_text(patterns: Patterns) -> str:
    """Return :func:`edge_table` as CSV."""
    return csv_text(_HEAD, edge_table(patterns), NOTES)


def edge_table(patterns: Patterns) -> list[tuple]:
    """Return one row per edge of every piece.

    Returns
    -------
    list of tuple
        Label of the piece, the two nodes, kind (``fold`` inside a piece, or ``inner`` where it is not folded; ``cut``,
        ``seam`` or ``crease`` between pieces; ``edge`` at the boundary), length in space and in the plane [mm], angle between
        the faces [degree], number of the seam and label of the neighbouring piece, or empty.
    """
    own = patterns.patchwork
    out = outline_sides(own)
    mate = mates(own.faces)
    u, v = own.faces, np.roll(own.faces, -1, axis=1)
    # Inner edges once, outline edges once per piece, without lines of subdivision.
    wanted = out | ((own.side != NONE) & (mate > np.arange(mate.size).reshape(mate.shape)))
    space = np.linalg.norm(own.space[u] - own.space[v], axis=2)
    plane = np.linalg.norm(np.roll(own.plane, -1, axis=1) - own.plane, axis=2)
    seam_of = {}
    for seam in patterns.seams:
        for a, b in zip(seam.nodes[:-1].tolist(), seam.nodes[1:].tolist()):
            seam_of[min(a, b), max(a, b)] = seam.number
    creased = folded(patterns, 0.0)
    rows, scale = [], 1e3 * metres(patterns.problem.drawing.units)
    faces, corners = np.nonzero(wanted)
    order = np.lexsort((corners, faces, own.piece[faces]))
    for f, c in zip(faces[order].tolist(), corners[order].tolist()):
        a, b = int(u[f, c]), int(v[f, c])
        beyond = patterns.pieces[own.piece[mate[f, c] // 3]].label if out[f, c] and mate[f, c] >= 0 else ""
        number = seam_of.get((min(a, b), max(a, b)), "") if out[f, c] else ""
        rows.append(
            (
                patterns.pieces[own.piece[f]].label,
                int(own.names[a]),
                int(own.names[b]),
                "inner" if own.side[f, c] == EDGE and not creased[f, c] else SIDES[own.side[f, c]],
                f"{scale * space[f, c]:.9f}",
                f"{scale * plane[f, c]:.9f}",
                f"{np.degrees(patterns.folds[f, c]):.4f}",
                number,
                beyond,
            )
        )
    return rows
