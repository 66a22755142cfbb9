"""Pieces: straight cuts of a flat surface until every piece fits on a sheet."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial import QhullError

from .._compiled import kernel
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from .patchwork import CREASE
from .patchwork import SIDES
from .patchwork import Patchwork
from .patchwork import connected_pieces
from .patchwork import mates
from .patchwork import outline_sides
from .patchwork import split_piece

__all__ = ["CUT_TOLERANCE", "Box", "best_box", "contacts", "cut_to_fit", "parted", "refuse_many"]

SNAP_TOLERANCE = 1e-9  # distance of a node from a cut, relative to the size of the piece, that counts as zero
MAX_PIECES = 5000
POSITIONS = 9  # of a joint that are compared
CUT_TOLERANCE = 1e-7  # distance of a node from a cut, relative to the size of the piece, below which the cut passes through it
SLACK = 1e-6  # of a sheet that a joint leaves free, so that this tolerance does not make a piece too large


class Box(NamedTuple):
    """Bounding rectangle of points, rotated to suit a sheet."""

    along: FloatArray  # (2,) unit vector along its length
    length: float  # along it [L]
    width: float  # across [L]
    parts: float  # least number of sheets


def best_box(points: FloatArray, sheet: tuple[float, float], along: Optional[FloatArray] = None) -> Box:
    """Return the bounding rectangle of points (k, 2) [L] that needs the fewest sheets, and of these the smallest.

    A direction (2,) of the length of the sheet may be given, as for a grain.
    """
    hull = points[_hull(points)]
    if along is not None:
        length, width = np.ptp(hull @ along), np.ptp(hull @ [-along[1], along[0]])
        return Box(along, float(length), float(width), float(np.ceil(length / sheet[0]) * np.ceil(width / sheet[1])))
    ahead = np.roll(hull, -1, axis=0) - hull
    angle = np.unique(np.round(np.r_[0.0, np.arctan2(ahead[:, 1], ahead[:, 0])] % (np.pi / 2), 9))
    boxes = []
    for side in np.column_stack([np.cos(angle), np.sin(angle)]):
        other = np.array([-side[1], side[0]])
        x, y = np.ptp(hull @ side), np.ptp(hull @ other)
        for axis, length, width in ((side, x, y), (other, y, x)):
            parts = np.ceil(length / sheet[0]) * np.ceil(width / sheet[1])
            boxes.append(Box(axis, float(length), float(width), float(parts)))
    return min(boxes, key=lambda box: (box.parts, round(box.length * box.width, 9)))


def cut_to_fit(
    patchwork: Patchwork,
    sheet: tuple[float, float],
    flattened: Optional[Callable[[Patchwork, int], Patchwork]] = None,
    too_wide: Optional[Callable[[Patchwork, int], bool]] = None,
    taken: Optional[Callable[[Patchwork, int], FloatArray]] = None,
    before_cut: Optional[Callable[[Patchwork, int, Box], None]] = None,
    grain: Optional[Callable[[Patchwork, int], FloatArray]] = None,
    shortest: float = 0.0,
) -> Patchwork:
    """Cut pieces by straight lines until each fits on a sheet and does not overlap itself.

    Parameters
    ----------
    patchwork
        The surface; its pieces may have any size.
    sheet
        Length and width of the sheets [L].
    flattened
        Function that flattens a piece again before it is checked. Default: pieces keep their positions.
    too_wide
        Function that decides whether a fitting piece must be cut nevertheless.
    taken
        Function that returns points (k, 2) around the room of a piece. Default: its corners.
    before_cut
        Function called with a piece and its rectangle before a cut; it may raise to stop. Default: all pieces may be cut.
    grain
        Function that returns the direction (2,) of a piece along the length of the sheet. Default: any direction.
    shortest
        Length of seams below which a cut is moved, if its pieces allow it [L].

    Returns
    -------
    Patchwork

    Raises
    ------
    ValueError
        If the sheet would give more than MAX_PIECES pieces.
    """
    refuse_many(patchwork, sheet)
    own = connected_pieces(patchwork)
    done: set[int] = set()
    while True:
        open_ = [piece for piece in range(int(own.piece.max()) + 1) if piece not in done]
        if not open_:
            return connected_pieces(own)
        for piece in open_:
            if flattened is not None:
                own = flattened(own, piece)
            corners = own.plane[own.piece == piece].reshape(-1, 2) if taken is None else taken(own, piece)
            box = best_box(corners, sheet, None if grain is None else grain(own, piece))
            if box.parts <= 1 and not overlaps(own, piece) and not (too_wide is not None and too_wide(own, piece)):
                done.add(piece)
                continue
            if before_cut is not None:
                before_cut(own, piece, box)
            if own.piece.max() > MAX_PIECES:
                raise _too_many(sheet)
            own = parted(_halved(own, piece, box, sheet, shortest), piece)


def refuse_many(patchwork: Patchwork, sheet: tuple[float, float]) -> None:
    """Refuse a sheet on which a surface would have more than MAX_PIECES pieces.

    Raises
    ------
    ValueError
        With a remedy.
    """
    ahead, back = patchwork.plane[:, 1] - patchwork.plane[:, 0], patchwork.plane[:, 2] - patchwork.plane[:, 0]
    if 0.5 * np.abs(ahead[:, 0] * back[:, 1] - ahead[:, 1] * back[:, 0]).sum() > MAX_PIECES * sheet[0] * sheet[1]:
        raise _too_many(sheet)


def _too_many(sheet: tuple[float, float]) -> ValueError:
    return ValueError(f"a sheet of {sheet[0]:g} x {sheet[1]:g} would give more than {MAX_PIECES} pieces; use larger sheets")


def _halved(own: Patchwork, piece: int, box: Box, sheet: tuple[float, float], shortest: float) -> Patchwork:
    """Cut a piece at the preferred position without short seams, or where the shortest seam is longest."""
    normal, levels = _levels(own, piece, box, sheet)
    tolerance = CUT_TOLERANCE * float(np.ptp(own.plane[own.piece == piece] @ normal))
    best, longest = own, -1.0
    for level in levels:
        cut = split_piece(own, piece, normal, level, tolerance)
        length = shortest_contact(cut, (piece, int(own.piece.max()) + 1)) if shortest > 0.0 else np.inf
        if length > longest:
            best, longest = cut, length
        if length >= shortest:
            break
    return best


def _levels(own: Patchwork, piece: int, box: Box, sheet: tuple[float, float]) -> tuple[FloatArray, list[float]]:
    """Return the normal of a cut and its possible levels along it, the preferred one first.

    With every level the two parts together need as many sheets along the normal as the piece.
    """
    across = np.array([-box.along[1], box.along[0]])
    if box.parts <= 1:
        normal = box.along if box.length >= box.width else across
        height = own.plane[own.piece == piece] @ normal
        return normal, [float(0.5 * (height.min() + height.max()))]
    along = box.length / sheet[0] >= box.width / sheet[1]
    normal, extent, full = (box.along, box.length, sheet[0]) if along else (across, box.width, sheet[1])
    count = max(2, int(np.ceil(extent / full - 1e-12)))
    height, first = own.plane[own.piece == piece] @ normal, count // 2
    room = full * (1.0 - SLACK) - (extent - np.ptp(height))  # the allowance needs the rest
    low, high = height.max() - room * (count - first), height.min() + room * first
    even = float(height.min() + np.ptp(height) * first / count)
    if not low < high:
        return normal, [even]
    even = float(np.clip(even, low, high))
    levels = np.append(even, np.linspace(low, high, POSITIONS))
    return normal, levels[np.argsort(np.abs(levels - even), kind="stable")].tolist()


def contacts(own: Patchwork, most: int = len(SIDES)) -> tuple[IntArray, FloatArray]:
    """Return the pairs of pieces that share sides of kinds below `most` (s, 2), and the length that they share (s,) [L]."""
    mate = mates(own.faces)
    other = np.where(mate >= 0, own.piece[mate // 3], -1)
    # Every common side is there twice.
    between = (other > own.piece[:, None]) & (own.side < most)
    lengths = np.linalg.norm(np.roll(own.plane, -1, axis=1) - own.plane, axis=2)[between]
    pairs = np.column_stack([np.broadcast_to(own.piece[:, None], other.shape)[between], other[between]])
    found, which = np.unique(pairs, axis=0, return_inverse=True)
    return found, np.bincount(which.ravel(), lengths, len(found)).astype(np.float64)


def shortest_contact(own: Patchwork, pieces: tuple[int, ...]) -> float:
    """Return the least length that one of some pieces shares with another piece, without creases; infinite if there is none [L]."""
    pairs, lengths = contacts(own, CREASE)
    return float(lengths[np.isin(pairs, pieces).any(axis=1)].min(initial=np.inf))


def parted(own: Patchwork, piece: int) -> Patchwork:
    """Renumber the connected parts of the two pieces of a cut, keeping other numbers."""
    parts = connected_pieces(own).piece
    labels = own.piece.copy()
    free = int(labels.max()) + 1
    for old in (piece, free - 1):
        for part in np.unique(parts[own.piece == old])[1:]:
            labels[parts == part] = free
            free += 1
    return replace(own, piece=labels)


def overlaps(own: Patchwork, piece: int) -> bool:
    """Check whether the outline of a piece crosses itself in the plane."""
    inside = own.piece == piece
    out = outline_sides(own) & inside[:, None]
    start, end = own.plane[out], np.roll(own.plane, -1, axis=1)[out]
    order = np.argsort(np.minimum(start[:, 0], end[:, 0]), kind="stable")
    return bool(_crossing(start[order], end[order], SNAP_TOLERANCE * float(np.ptp(start, axis=0).max())))


def _hull(points: FloatArray) -> IntArray:
    try:
        return ConvexHull(points).vertices.astype(np.int64)
    except QhullError:
        return np.arange(len(points))


@kernel()
def _crossing(start: FloatArray, end: FloatArray, tolerance: float) -> bool:
    """Check whether two of the segments (k, 2), sorted by their smaller x, cross by more than a tolerance [L]."""
    for i in range(len(start)):
        a0, a1, b0, b1 = start[i, 0], start[i, 1], end[i, 0], end[i, 1]
        right = max(a0, b0)
        one = np.hypot(b0 - a0, b1 - a1)
        for j in range(i + 1, len(start)):
            p0, p1, q0, q1 = start[j, 0], start[j, 1], end[j, 0], end[j, 1]
            if min(p0, q0) > right:
                break
            if max(p1, q1) < min(a1, b1) or min(p1, q1) > max(a1, b1):
                continue
            two = np.hypot(q0 - p0, q1 - p1)
            if one == 0.0 or two == 0.0:
                continue
            p = ((b0 - a0) * (p1 - a1) - (b1 - a1) * (p0 - a0)) / one
            q = ((b0 - a0) * (q1 - a1) - (b1 - a1) * (q0 - a0)) / one
            a = ((q0 - p0) * (a1 - p1) - (q1 - p1) * (a0 - p0)) / two
            b = ((q0 - p0) * (b1 - p1) - (q1 - p1) * (b0 - p0)) / two
            apart = min(abs(p), abs(q), abs(a), abs(b)) > tolerance
            if apart and p * q < 0.0 and a * b < 0.0:
                return True
    return False
