"""Cut list: one row per piece for the workshop."""

from __future__ import annotations

import numpy as np

from ..errors import names_what_was_meant
from .assembly import courses
from .assembly import neighbours
from .figures import in_mm
from .figures import in_square_metres
from .figures import metres
from .patterns import Patterns
from .patterns import refuse_others
from .piece_bending import pieces_in_position
from .piece_checks import at_sheet_edge
from .piece_checks import contours
from .piece_checks import sharpest_corner
from .sheet_drawing import folded
from .sheet_drawing import rolled_regions
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
    "strain in %",
    "seam difference in mm",
    "at seam",
    "sharpest corner in degrees",
    "on edge of sheet",
    "least bending radius in mm",
    "bends",
    "material",
    "thickness in mm",
)


UNKNOWN = "as neighbours"  # bends of a piece in a rolled region on which no ruling lies
NOTES = (
    "length, width and perimeter: of the contour that is cut; length and width are those of the rectangle around it on the sheet",
    "course: suggested order of assembly, 1 for pieces on supports, or for the lowest piece of a part without supports, 2 for "
    "their neighbours, and so on",
    "on edge of sheet: a side of the piece lies on the edge of its sheet and is not trimmed",
    "bends: direction in which the edges of the piece bend, for a viewer outside: away from the viewer, towards, or both; least bending "
    "radius: in the final position, across rulings for K = 0, otherwise the smaller principal radius; not smaller on 95 % of the area",
    f"{UNKNOWN}: no radius is known, because no ruling crosses the piece; bend it by hand until its seams meet those of its neighbours",
    "mould: surface of constant K on which a piece with K other than 0 is pressed before it is bent to its place",
    "strain: largest stretch or compression of pressing; seam difference: largest difference in length between the two flat sides of one "
    "of its seams, and the number of this seam; the edge table (the separate file -o NAME.csv) has all lengths",
    "piece: a letter for the region (A for 0) and a number; if the surface was divided into panels, the name of the panel, as in the "
    "mould report",
    "sharpest corner: between two sides of the outline, before kerf and allowance",
)


def cut_list_text(patterns: Patterns) -> str:
    """Return :func:`cut_list` as CSV."""
    return csv_text(_HEAD, cut_list(patterns), NOTES)


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
        course from the supports; mould, empty if K = 0; largest strain [%]; largest difference between the sides of a seam [mm], and its
        number; sharpest corner [degree]; ``yes`` if a contour lies on the edge of the sheet; least radius of bending in position [mm],
        and whether the piece bends away from its outside, towards it or both; without a radius ``as neighbours`` if only other pieces of
        the region have rulings, empty if none has; material and thickness of the sheets [mm], empty if not given.

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
    rows, stuff = [], (patterns.stock.material, f"{patterns.stock.thickness:g}" if patterns.stock.thickness else "")
    rolled, ruled = rolled_regions(patterns), {ruling.piece for ruling in patterns.rulings}
    bent, differences = pieces_in_position(patterns), _seam_differences(patterns)
    for number, (piece, beside, course) in enumerate(zip(patterns.pieces, neighbours(patterns), courses(patterns))):
        loops = contours(piece)
        sides = np.ptp(loops[0], axis=0)
        around = sum(float(np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1).sum()) for loop in loops)
        lengths = [in_mm([length], units).removesuffix(" mm") for length in (max(sides), min(sides), around)]
        labels = " ".join(patterns.pieces[k].label for k in beside)
        area = in_square_metres(piece.area, units)
        mould = _mould(patterns, piece.region)
        about = (piece.sheet + 1, piece.label, piece.region, area, *lengths, round(folds[number]), labels, course, mould)
        edge = "yes" if at_sheet_edge(patterns, piece) else ""
        fit = f"{100.0 * piece.strain:.3f}", *differences[number]
        radius, sides = bent[number]
        by_hand = piece.region in rolled and number not in ruled
        bends = (f"{1e3 * metres(units) * radius:.0f}" if sides else "", UNKNOWN if by_hand else sides)
        rows.append((*about, *fit, f"{np.degrees(sharpest_corner(piece)):.1f}", edge, *bends, *stuff))
    return sorted(rows, key=lambda row: row[0])


def _seam_differences(patterns: Patterns) -> list[tuple[str, str]]:
    """Return the largest difference between the flat sides of a seam of every piece [mm], and the number of the seam."""
    mm = 1e3 * metres(patterns.problem.drawing.units)
    largest: list[tuple[float, str]] = [(-1.0, "")] * len(patterns.pieces)
    for seam in patterns.seams:
        difference = mm * abs(seam.lengths[0] - seam.lengths[1])
        for piece in seam.pieces:
            largest[piece] = max(largest[piece], (difference, str(seam.number)), key=lambda own: own[0])
    return [(f"{difference:.2f}" if number else "", number) for difference, number in largest]


def _mould(patterns: Patterns, region: int) -> str:
    target = next(own.target for own in patterns.unrollings if own.region == region)
    if not target:
        return "" if target == 0 else "several K"
    return f"{'sphere' if target > 0 else 'pseudosphere'} of radius {in_mm([abs(target) ** -0.5], patterns.problem.drawing.units)}"
