"""Nesting of true shapes on sheets, with the package spyrrow."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..errors import CGCError
from .outlines import signed_area

if TYPE_CHECKING:
    from types import ModuleType

__all__ = ["Position", "nest_shapes"]

SECONDS = 1  # for the pieces of one sheet; the least that spyrrow takes
MAX_FILL = 0.95  # of a sheet, above which nesting is not tried
CANDIDATES = 3  # sheets that are tried for a piece
ATTEMPTS = 40  # of nesting a sheet, which limits the run time
TOLERANCE = 1e-6  # relative; spyrrow computes with single precision


class Position(NamedTuple):
    """Position of a shape: rotated about the origin, then shifted."""

    angle: float  # [rad]
    shift: FloatArray  # (2,) [L]


def nest_shapes(
    outlines: Sequence[FloatArray], sheets: Sequence[int], room: tuple[float, float], spacing: float, turn: bool = True
) -> tuple[list[int], dict[int, Position]]:
    """Return positions of shapes on fewer sheets than a given nesting uses, as far as these are found.

    The emptiest sheets are cleared one after the other: each of their shapes moves to a fuller sheet, whose shapes are nested again. The
    search is limited by time, so that results may differ between runs.

    Parameters
    ----------
    outlines
        Outlines (k, 2) [L].
    sheets
        Sheet of every shape in the given nesting, from 0.
    room
        Length and width of the sheets [L].
    spacing
        Distance between shapes [L].
    turn
        Whether shapes may have any rotation. Otherwise they may be turned by 180 degrees.

    Returns
    -------
    list of int
        Sheet of every shape.
    dict of int to Position
        New positions by shape; the other shapes keep theirs.

    Raises
    ------
    CGCError
        If spyrrow is not installed.
    """
    try:
        import spyrrow
    except ImportError:
        raise CGCError("nesting of true shapes needs the package spyrrow; install compas_cgc[nesting]") from None
    areas = np.array([abs(signed_area(outline)) for outline in outlines])
    own = np.asarray(sheets, dtype=np.int64).copy()
    found: dict[int, Position] = {}
    attempts = 0
    full = MAX_FILL * room[0] * room[1]
    for sheet in np.argsort(np.bincount(own, areas), kind="stable").tolist():
        tried, placed = own.copy(), dict(found)
        for shape in np.flatnonzero(own == sheet)[np.argsort(-areas[own == sheet], kind="stable")].tolist():
            used = np.bincount(tried, areas, int(own.max()) + 1)
            others = [k for k in np.argsort(-used, kind="stable").tolist() if k != sheet and used[k] and used[k] + areas[shape] <= full]
            for other in others[:CANDIDATES]:
                inside = [*np.flatnonzero(tried == other).tolist(), shape]
                if attempts >= ATTEMPTS:
                    break
                attempts += 1
                places = _on_one(spyrrow, [outlines[k] for k in inside], room, spacing, turn)
                if places is not None:
                    tried[shape] = other
                    placed.update(zip(inside, places))
                    break
            else:
                break
            if tried[shape] == sheet:
                break
        if not (tried == sheet).any():
            own, found = tried, placed
    return np.unique(own, return_inverse=True)[1].ravel().tolist(), found


def _on_one(
    spyrrow: ModuleType, outlines: Sequence[FloatArray], room: tuple[float, float], spacing: float, turn: bool
) -> Optional[list[Position]]:
    """Return angles and shifts of shapes on one sheet, None if they were not found."""
    angles = None if turn else [0.0, 180.0]
    items = [spyrrow.Item(str(k), [tuple(point) for point in outline.tolist()], 1, angles) for k, outline in enumerate(outlines)]
    config = spyrrow.StripPackingConfig(
        total_computation_time=SECONDS, min_items_separation=spacing if spacing > 0.0 else None, num_workers=1, seed=0
    )
    solution = spyrrow.StripPackingInstance("sheet", room[1], items).solve(config)
    if solution.width > room[0] * (1.0 + TOLERANCE):
        return None
    places = [Position(0.0, np.zeros(2))] * len(outlines)
    for item in solution.placed_items:
        places[int(item.id)] = Position(float(np.radians(item.rotation)), np.array(item.translation))
    return places
