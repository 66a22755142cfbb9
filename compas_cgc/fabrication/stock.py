"""Stock: sheets, and what has to stay free on them."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np

from ..errors import CGCError
from ..model.given import checked_number

__all__ = ["Stock", "stock_of"]

KERF = 0.01  # of the width of sheets, that pieces are apart where nothing is said
LIMIT = 4.0  # of an allowance, how far from a corner its mitre reaches at most


class Stock(NamedTuple):
    """Sheets, and what stays free on them."""

    sheet: Optional[tuple[float, float]]  # length and width [L]; None where there is no end of it
    spacing: Optional[float]  # between pieces [L]; None where there are no sheets to tell it by
    margin: float  # along the edges of a sheet [L]
    allowance: float  # around every piece [L]

    @property
    def room(self) -> tuple[float, float]:
        """Length and width of a sheet inside of its margins [L]."""
        return (np.inf, np.inf) if self.sheet is None else (self.sheet[0] - 2 * self.margin, self.sheet[1] - 2 * self.margin)


def stock_of(sheet: Optional[tuple[float, float]], spacing: Optional[float], margin: float, allowance: float) -> Stock:
    """Return stock when it is such.

    Parameters
    ----------
    sheet
        Length and width [L], in any order. None: no end of it.
    spacing
        Between pieces [L]. None: a hundredth of the width of the sheets, room for a saw or a router and its way in.
    margin
        Along the edges of sheets [L].
    allowance
        Around every piece [L].

    Raises
    ------
    CGCError
        If a number is none or negative, or there is no room left on a sheet.
    """
    size = _size(sheet)
    lengths = {
        "spacing between pieces": None if spacing is None else checked_number(spacing, "spacing"),
        "margin at the edges of a sheet": checked_number(margin, "margin"),
        "allowance around pieces": checked_number(allowance, "allowance"),
    }
    for what, length in lengths.items():
        if length is not None and not 0 <= length < np.inf:
            raise CGCError(f"the {what} must be 0 or more, not {length:g}")
    if size is not None and not 2 * margin < size[1]:
        raise CGCError(f"margins of {margin:g} leave nothing of a sheet of {size[0]:g} x {size[1]:g}; they are in the units of the drawing")
    if size is not None and spacing is not None and not spacing < size[1]:
        raise CGCError(
            f"a spacing of {spacing:g} is as wide as a sheet of {size[0]:g} x {size[1]:g}; it is in the units of the drawing, such as "
            f"{KERF * size[1]:g}"
        )
    # Room for the mitres of the smallest piece, so that cutting comes to an end.
    if size is not None and not 2 * margin + 2 * LIMIT * allowance < size[1]:
        raise CGCError(
            f"an allowance of {allowance:g} leaves no room for pieces on a sheet of {size[0]:g} x {size[1]:g}; take less than "
            f"{(size[1] - 2 * margin) / (2 * LIMIT):.3g}, in the units of the drawing"
        )
    return Stock(size, KERF * size[1] if spacing is None and size is not None else spacing, margin, allowance)


def _size(sheet: Optional[tuple[float, float]]) -> Optional[tuple[float, float]]:
    if sheet is None:
        return None
    try:
        length, width = (float(x) for x in sheet)
    except (TypeError, ValueError):
        raise CGCError(f"a sheet must have a length and a width, such as (3.0, 1.5), not {sheet!r}") from None
    if not (np.isfinite([length, width]).all() and min(length, width) > 0):
        raise CGCError(f"a sheet must have a length and a width more than 0, such as 3.0 x 1.5, not {length:g} x {width:g}")
    return max(length, width), min(length, width)
