"""Checks of pieces for the workshop: sharp corners, and contours along the edge of a sheet."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..discrete.arrays import FloatArray
from ..model.counts import listed

if TYPE_CHECKING:
    from .patterns import Patterns
    from .patterns import Piece

__all__ = ["MIN_CORNER", "at_sheet_edge", "contours", "remarks", "sharpest_corner"]

MIN_CORNER = np.radians(15.0)  # corners below it are named: they break, burn or bend when they are cut
POINT_TOLERANCE = 1e-6  # distance of points relative to the size of a contour below which they count as one
EDGE_TOLERANCE = 1e-4  # distance from the edge of a sheet relative to its length below which a contour lies on it


def contours(piece: Piece) -> list[FloatArray]:
    """Return the contours (k, 2) along which a piece is cut, the outer one first [L]."""
    return piece.allowance or [loop.points for loop in piece.loops]


def sharpest_corner(piece: Piece) -> float:
    """Return the least angle inside an outline of a piece [rad]; contours beside it, as in the middle of a kerf, cut corners off."""
    return min(float(_corners(loop.points).min(initial=np.pi)) for loop in piece.loops)


def _corners(loop: FloatArray) -> FloatArray:
    """Return the angles inside a contour (k, 2) that has the piece to its left [rad]."""
    long = np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1)
    points = loop[long > POINT_TOLERANCE * np.ptp(loop, axis=0).max()]
    ahead, back = np.roll(points, -1, axis=0) - points, np.roll(points, 1, axis=0) - points
    turn = np.arctan2(ahead[:, 0] * back[:, 1] - ahead[:, 1] * back[:, 0], np.einsum("ij,ij->i", ahead, back))
    return np.where(turn < 0.0, turn + 2.0 * np.pi, turn)


def at_sheet_edge(patterns: Patterns, piece: Piece) -> bool:
    """Check whether a contour of a piece lies on the edge of its sheet, so that no cut trims the sheet there."""
    if not patterns.sheet_sizes:
        return False
    size = np.array(patterns.sheet_sizes[piece.sheet])
    outer = contours(piece)[0]
    return float(min(outer.min(), (size - outer).min())) < EDGE_TOLERANCE * size.max()


def remarks(patterns: Patterns) -> list[str]:
    """Return sentences that name the pieces with sharp corners, and those on the edge of a sheet."""
    found = []
    sharp = [(piece.label, np.degrees(sharpest_corner(piece))) for piece in patterns.pieces if sharpest_corner(piece) < MIN_CORNER]
    if sharp:
        named = ", ".join(f"{label} ({angle:.1f})" for label, angle in sharp)
        found.append(f"corners sharper than {np.degrees(MIN_CORNER):g} degrees: {named}")
    edge = [piece.label for piece in patterns.pieces if at_sheet_edge(patterns, piece)]
    if edge:
        which = "all pieces" if len(edge) == len(patterns.pieces) else f"pieces {listed(edge, 'see the cut list')}"
        found.append(f"{which} lie on the edge of their sheet, which needs straight and square edges; a margin keeps edges free")
    return found
