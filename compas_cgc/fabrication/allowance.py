"""Allowances: strips of constant width around pieces, mitred at corners."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..discrete.arrays import FloatArray
from ..errors import CGCError
from .outlines import signed_area
from .stock import MITRE_LIMIT

__all__ = ["reach", "widened"]

POINT_TOLERANCE = 1e-9  # distance relative to the width of a strip below which two points coincide


class _Strip(NamedTuple):
    """The strip along a closed outline (k, 2), edge by edge."""

    before: FloatArray  # (k, 2) outer end of the strip of the edge before a point [L]
    after: FloatArray  # (k, 2) outer start of the strip of the edge after it; the same point at a mitre [L]


def reach(loops: Sequence[FloatArray], width: float) -> FloatArray:
    """Return points (n, 2) with the convex hull of a piece and its allowance [L].

    Parameters
    ----------
    loops
        Closed outlines ``(k, 2)`` with the piece to their left, the outer one first [L].
    width
        Width of the strip [L].
    """
    strips = [_strip(loop, width) for loop in loops]
    return np.concatenate([*loops, *(side for strip in strips for side in strip)])


def widened(loops: Sequence[FloatArray], width: float) -> list[FloatArray]:
    """Return the outlines of a piece with its allowance: the outer one counterclockwise, holes clockwise.

    Every edge is offset outwards by the width, with mitred corners; mitres longer than four widths are cut off square.

    Parameters
    ----------
    loops
        Closed outlines ``(k, 2)`` with the piece to their left, the outer one first [L].
    width
        Width of the strip [L]; 0 gives no outlines.

    Raises
    ------
    CGCError
        If shapely is not installed.
    """
    if not width:
        return []
    try:
        import shapely
    except ImportError:
        raise CGCError("an allowance needs the package shapely; install compas_cgc[fabrication]") from None
    pieces = [np.array([shapely.make_valid(shapely.Polygon(loops[0], loops[1:]))])]
    for loop in loops:
        before, after = _strip(loop, width)
        edges = np.stack([loop, np.roll(loop, -1, axis=0), np.roll(before, -1, axis=0), after], axis=1)
        pieces += [np.asarray(shapely.polygons(own)) for own in (edges, np.stack([loop, before, after], axis=1))]
    parts = np.concatenate(pieces)
    whole = shapely.union_all(parts[shapely.area(parts) > 0])
    rings = [shapely.get_coordinates(ring)[:-1] for ring in np.atleast_1d(shapely.get_rings(whole))]
    return [_cleaned(ring, width) if (signed_area(ring) > 0) == (k == 0) else _cleaned(ring[::-1], width) for k, ring in enumerate(rings)]


def _cleaned(ring: FloatArray, width: float) -> FloatArray:
    """Return a ring without duplicate points, which Rhino rejects."""
    return ring[np.linalg.norm(ring - np.roll(ring, 1, axis=0), axis=1) > POINT_TOLERANCE * width]


def _strip(loop: FloatArray, width: float) -> _Strip:
    ahead = np.roll(loop, -1, axis=0) - loop
    along = ahead / np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), np.finfo(float).tiny)
    back = np.roll(along, 1, axis=0)
    out = np.array([[0.0, -1.0], [1.0, 0.0]])  # rotation to the right of a direction, away from the piece
    cosine = np.clip(np.einsum("ij,ij->i", back, along), -1.0, 1.0)
    left = back[:, 0] * along[:, 1] - back[:, 1] * along[:, 0] > 0
    # Cosine and sine of half the turn at a corner; mitres beyond MITRE_LIMIT are cut off perpendicular to the bisector.
    c, s = np.sqrt(0.5 * (1.0 + cosine)), np.sqrt(0.5 * (1.0 - cosine))
    mitred = left & (MITRE_LIMIT * c >= 1.0)
    square = left & ~mitred
    longer = np.where(square, (MITRE_LIMIT - c) / np.maximum(s, 0.5), 0.0)[:, None]
    tip = loop + width * ((back + along) @ out) / np.maximum(1.0 + cosine, 1e-3)[:, None]
    before = np.where(mitred[:, None], tip, loop + width * (back @ out + longer * back))
    after = np.where(mitred[:, None], tip, loop + width * (along @ out - longer * along))
    return _Strip(before, after)
