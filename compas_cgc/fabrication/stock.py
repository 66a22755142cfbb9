"""Stock: sheet size, spacing, margin and allowance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np

from ..errors import CGCError
from ..model.given import checked_number
from .materials import refuse_foil

__all__ = ["Stock", "stock_of"]

DEFAULT_SPACING = 0.01  # default distance between pieces relative to the sheet width
MITRE_LIMIT = 4.0  # largest mitre length in allowances


class Stock(NamedTuple):
    """Sheet size, spacing, margin and allowance."""

    sheet: Optional[tuple[float, float]]  # length and width [L]; None if unlimited
    spacing: Optional[float]  # between pieces [L]; None until known for unlimited sheets
    margin: float  # along the edges of a sheet [L]
    allowance: float  # around every piece [L]
    smaller: tuple[tuple[float, float], ...] = ()  # length and width of further sheets, the smallest first [L]
    grain: Optional[tuple[float, float]] = None  # direction in plan along the length of the sheets; None for any
    kerf: float = 0.0  # width that the tool removes [L]
    material: str = ""  # empty if not given
    thickness: float = 0.0  # [mm], 0 if not given

    @property
    def stuff(self) -> str:
        """Material and thickness in words, such as ``plywood, 12 mm thick``; empty if neither is given."""
        return ", ".join(part for part in (self.material, f"{self.thickness:g} mm thick" if self.thickness else "") if part)

    @property
    def strip(self) -> float:
        """Width of the strip around every piece up to the middle of the cut [L]."""
        return self.allowance + 0.5 * self.kerf

    @property
    def room(self) -> tuple[float, float]:
        """Length and width of a sheet inside its margins [L]."""
        return self.inside(self.sheet)

    def inside(self, sheet: Optional[tuple[float, float]]) -> tuple[float, float]:
        """Return length and width of a sheet inside its margins [L]."""
        return (np.inf, np.inf) if sheet is None else (sheet[0] - 2 * self.margin, sheet[1] - 2 * self.margin)


def stock_of(
    sheet: Union[tuple[float, float], Sequence[tuple[float, float]], None],
    spacing: Optional[float],
    margin: float,
    allowance: float,
    grain: Optional[tuple[float, float]] = None,
    kerf: float = 0.0,
    material: str = "",
    thickness: float = 0.0,
) -> Stock:
    """Return the validated stock.

    Parameters
    ----------
    sheet
        Length and width [L], in any order, or several of them. None: unlimited.
    spacing
        Distance between pieces [L]. None: 1 % of the sheet width, enough for a saw or router.
    margin
        Free margin along the edges of sheets [L].
    allowance
        Width of the strip around every piece [L].
    grain
        Direction in plan along the length of the sheets. None: any.
    kerf
        Width that the tool removes [L].
    material, thickness
        Material and thickness of the sheets [mm].

    Raises
    ------
    CGCError
        If a value is not a number or negative, or leaves no room on a sheet.
    """
    sizes = sorted(map(_size, _several(sheet)), key=lambda size: size[0] * size[1])
    size = sizes[-1] if sizes else None
    if grain is not None and not (len(grain) == 2 and np.isfinite(grain).all() and np.hypot(*grain) > 0.0):
        raise CGCError(f"the grain must be a direction in plan, such as (1, 0), not {grain!r:.60}")
    lengths = {
        "spacing between pieces": None if spacing is None else checked_number(spacing, "spacing"),
        "margin at the edges of a sheet": checked_number(margin, "margin"),
        "allowance around pieces": checked_number(allowance, "allowance"),
        "kerf of the tool": checked_number(kerf, "kerf"),
        "thickness of the sheets": checked_number(thickness, "thickness"),
    }
    for what, length in lengths.items():
        if length is not None and not 0 <= length < np.inf:
            raise CGCError(f"the {what} must be at least 0, not {length:g}")
    if thickness:
        refuse_foil(thickness)
    if size is not None and not 2 * margin < size[1]:
        raise CGCError(
            f"margins of {margin:g} leave no room on a sheet of {size[0]:g} x {size[1]:g}; check the units, which are those of the drawing"
        )
    if size is not None and spacing is not None and not spacing < size[1]:
        raise CGCError(
            f"a spacing of {spacing:g} is too large for a sheet of {size[0]:g} x {size[1]:g}; give it in the units of the drawing, such as "
            f"{DEFAULT_SPACING * size[1]:g}"
        )
    # Without room for the mitres of the smallest piece, cutting would not terminate.
    if size is not None and not 2 * margin + 2 * MITRE_LIMIT * (allowance + 0.5 * kerf) < size[1]:
        raise CGCError(
            f"an allowance of {allowance + 0.5 * kerf:g} leaves no room for pieces on a sheet of {size[0]:g} x {size[1]:g}; use less than "
            f"{(size[1] - 2 * margin) / (2 * MITRE_LIMIT):.3g}, in the units of the drawing"
        )
    apart = DEFAULT_SPACING * size[1] if spacing is None and size is not None else spacing
    if not isinstance(material, str):
        raise CGCError(f"the material must be a name, such as plywood, not {material!r:.60}")
    along = None if grain is None else (float(grain[0]), float(grain[1]))
    return Stock(size, apart, margin, allowance, tuple(sizes[:-1]), along, kerf, material.strip(), float(thickness))


def _several(sheet: object) -> list[object]:
    """Return sheets as a list of sizes."""
    if sheet is None:
        return []
    return list(sheet) if isinstance(sheet, (list, tuple)) and sheet and isinstance(sheet[0], (list, tuple)) else [sheet]


def _size(sheet: Any) -> tuple[float, float]:
    try:
        length, width = (float(x) for x in sheet)
    except (TypeError, ValueError):
        raise CGCError(f"a sheet must have a length and a width, such as (3.0, 1.5), not {sheet!r}") from None
    if not (np.isfinite([length, width]).all() and min(length, width) > 0):
        raise CGCError(f"the length and width of a sheet must be positive, such as 3.0 x 1.5, not {length:g} x {width:g}")
    return max(length, width), min(length, width)
