"""Cut list: one row per piece for the workshop."""

from __future__ import annotations

import numpy as np

from ..errors import names_what_was_meant
from .assembly import courses
from .assembly import neighbours
from .drawing import folded
from .figures import in_mm
from .figures import in_square_metres
from .patterns import Patterns
from .patterns import refuse_others
from .tables import csv_text

__all__ = ["cut_list", "cut_list_text"]

_HEAD = (
    "sheet",
    "piece",
    "region",
    "area in m2",
    "length in mm",
    "width in mm",
    "perimeter in mm",
    "folds",
    "neighbours",
    "course",
    "mould",
)


def cut_list_text(patterns: Patterns) -> str:
    """Return :func:`cut_list` as CSV."""
    return csv_text(_HEAD, cut_list(patterns))


@names_what_was_meant()
def cut_list(patterns: Patterns) -> list[tuple]:
    """Return the rows of the cut list, in the order of the sheets.

    Parameters
    ----------
    patterns
        Result of :func:`compas_cgc.fabrication.unroll`.

    Returns
    -------
    list of tuple
        Number of the sheet, from 1; name and region of the piece; area without allowance [m2], three decimals; length and width
        of the bounding rectangle, and the cutting length with holes [mm], one decimal; number of folds; names of neighbours;
        course from the supports; mould, empty if K = 0.

    Examples
    --------
    >>> import compas_cgc
    >>> from compas_cgc.fabrication import unroll
    >>> patterns = unroll(compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm"))), (3.0, 1.5))
    >>> len(cut_list(patterns)) == len(patterns.pieces)
    True
    """
    refuse_others(patterns, "a cut list is made", "cut_list")
    units = patterns.problem.drawing.units
    own = patterns.patchwork
    # Both faces of an edge count its fold.
    folds = np.bincount(own.piece, folded(patterns).sum(axis=1), len(patterns.pieces)) / 2
    rows = []
    for number, (piece, beside, course) in enumerate(zip(patterns.pieces, neighbours(patterns), courses(patterns))):
        loops = piece.allowance or [loop.points for loop in piece.loops]
        sides = np.ptp(loops[0], axis=0)
        around = sum(float(np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1).sum()) for loop in loops)
        lengths = [in_mm([length], units).removesuffix(" mm") for length in (max(sides), min(sides), around)]
        labels = " ".join(patterns.pieces[k].label for k in beside)
        area = in_square_metres(piece.area, units)
        mould = _mould(patterns, piece.region)
        rows.append((piece.sheet + 1, piece.label, piece.region, area, *lengths, round(folds[number]), labels, course, mould))
    return sorted(rows, key=lambda row: row[0])


def _mould(patterns: Patterns, region: int) -> str:
    target = next(own.target for own in patterns.unrollings if own.region == region)
    if not target:
        return "" if target == 0 else "several K"
    return f"{'sphere' if target > 0 else 'pseudosphere'} of radius {in_mm([abs(target) ** -0.5], patterns.problem.drawing.units)}"
