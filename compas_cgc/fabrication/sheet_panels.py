"""Panels of curved regions that fit on sheets when they are flattened."""

from __future__ import annotations

from collections.abc import Callable
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..model.problem import CGCProblem
from .figures import metres
from .grid_lines import Division
from .nesting import nest
from .panelling import Panel
from .panelling import grid_panels
from .patchwork import Patchwork
from .pieces import best_box
from .pieces import contacts
from .quarter_turn import centre_of
from .quarter_turn import is_fourfold
from .quarter_turn import middles_of
from .quarter_turn import turns_onto_itself
from .regions_in_plane import developed_panels
from .stock import Stock

__all__ = ["sheet_panels"]

SCALES = (1.0, 0.95, 0.9, 0.85, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3)  # sides of panels along the surface that are tried, relative to a sheet


def sheet_panels(
    problem: CGCProblem,
    regions: list[int],
    stock: Stock,
    shortest: float,
    taken: Callable[[Patchwork, int], FloatArray],
    too_wide: Callable[[Patchwork, int], bool],
    cut: Callable[[Patchwork], Patchwork],
) -> Optional[list[Panel]]:
    """Return panels of the best grid or strips, None if the mesh is too coarse for a grid.

    The best ones have the fewest short seams, have the symmetry of a roof that a quarter turn takes to itself, and then need the fewest
    sheets. Strips are cut one by one, so that their joints meet those
    of other strips and regions at short seams, and differ between parts of a roof that are alike; joints of a grid continue. Strips, and
    single panels, may be larger than a sheet, and are then to be cut.

    Parameters
    ----------
    problem
        The surface.
    regions
        Numbers of the regions.
    stock
        The sheets.
    shortest
        Length of a short seam [mm]; grid lines are moved to avoid them, if possible.
    taken
        Function that returns points around the room of a piece (k, 2) [L].
    too_wide
        Function that decides whether a piece has too much strain.
    cut
        Function that cuts pieces until they fit on sheets.
    """
    best: Optional[tuple[tuple[int, bool, int], Division]] = None
    fourfold = turns_onto_itself(problem)
    centre = centre_of(problem)[:2]
    least = 1e-3 * shortest / metres(problem.drawing.units)

    def compare(largest: tuple[float, float], strips: bool = False) -> Optional[int]:
        """Keep the division if it is the best so far; return the most parts of a panel, None if the mesh is too coarse."""
        nonlocal best
        division = Division(largest=largest)
        try:
            flat = developed_panels(problem, grid_panels(problem, division, 0.0), regions)[0]
            flat = cut(flat) if strips else flat
        except ValueError:
            return None
        boxes = [best_box(taken(flat, piece), stock.room) for piece in range(int(flat.piece.max()) + 1)]
        parts = [int(max(box.parts, 1 + too_wide(flat, piece))) for piece, box in enumerate(boxes)]
        fitting = [box[1:3] for box, count in zip(boxes, parts) if count == 1]
        nested = 1 + max(place.sheet for place in nest(fitting, stock.room, stock.spacing or 0.0)) if fitting else 0
        sheets = nested + sum(count for count in parts if count > 1)
        key = int((contacts(flat)[1] < least).sum()), fourfold and not is_fourfold(*middles_of(flat), centre), sheets
        best = (key, division) if best is None or key < best[0] else best
        return max(parts)

    squares = [(min(stock.room), min(stock.room))] if fourfold else []
    for sides in (stock.room, stock.room[::-1], *squares):
        for scale in SCALES:
            most = compare((scale * sides[0], scale * sides[1]))
            if most is None or most == 1:
                break
    # Strips are cut to lengths one by one, so that lines that converge elsewhere do not shorten their panels.
    size = float(np.ptp(problem.vertices, axis=0).sum())
    for largest in ((size, min(stock.room)), (min(stock.room), size)):
        compare(largest, strips=True)
    return None if best is None else grid_panels(problem, best[1], shortest)
