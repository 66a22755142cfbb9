"""Placing of pieces on sheets."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from .allowance import reach
from .allowance import widened
from .nesting import Place
from .nesting import nest
from .outlines import outline_loops
from .patchwork import Patchwork
from .pieces import best_box
from .shape_nesting import nest_shapes
from .stock import DEFAULT_SPACING
from .stock import Stock

__all__ = ["Placed", "extent", "grain_of", "on_sheets"]


class Placed(NamedTuple):
    """Pieces on sheets."""

    patchwork: Patchwork
    sheets: list[int]  # sheet of every piece
    sizes: list[tuple[float, float]]  # length and width of every sheet [L]; empty for unlimited sheets
    stock: Stock  # with its spacing


def extent(own: Patchwork, piece: int, allowance: float) -> FloatArray:
    """Return points (k, 2) around a piece with its allowance [L]."""
    return own.plane[own.piece == piece].reshape(-1, 2) if not allowance else reach(_loops(own, piece), allowance)


def _loops(own: Patchwork, piece: int) -> list[FloatArray]:
    faces = own.piece == piece
    parts = {name: getattr(own, name)[faces] for name in ("faces", "plane", "side", "region", "parent")}
    alone = replace(own, **parts, piece=np.zeros(int(faces.sum()), np.int64))
    return [loop.points for loop in outline_loops(alone)[0]]


def grain_of(own: Patchwork, piece: int, grain: tuple[float, float]) -> FloatArray:
    """Return the mean direction (2,) of a direction in plan on a piece laid flat."""
    faces = own.piece == piece
    space, plane = own.space[own.faces[faces]], own.plane[faces]
    edges, flat = space[:, 1:] - space[:, :1], plane[:, 1:] - plane[:, :1]
    area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    # The direction projected to a face, as a combination of two edges.
    share = np.einsum("fki,fi->fk", np.linalg.pinv(edges.transpose(0, 2, 1)), np.broadcast_to([*grain, 0.0], (len(edges), 3)))
    mean = (area[:, None] * np.einsum("fk,fkj->fj", share, flat)).sum(axis=0)
    return mean / max(float(np.linalg.norm(mean)), np.finfo(float).tiny)


def on_sheets(own: Patchwork, stock: Stock, shapes: bool = False) -> Placed:
    """Place pieces on sheets by their rectangles, or by their true shapes, and return the smallest sheets that hold them."""
    turned, sizes, outlines = [], [], []
    for piece in range(int(own.piece.max()) + 1):
        taken = extent(own, piece, stock.strip)
        along = best_box(taken, stock.room, None if stock.grain is None else grain_of(own, piece, stock.grain)).along
        turn = np.column_stack([along, [-along[1], along[0]]])
        low = (taken @ turn).min(axis=0)
        turned.append(own.plane[own.piece == piece] @ turn - low)
        sizes.append((float(np.ptp(taken @ turn[:, 0])), float(np.ptp(taken @ turn[:, 1]))))
        if shapes and stock.sheet is not None:
            outlines.append((widened(_loops(own, piece), stock.strip) or _loops(own, piece))[0] @ turn - low)
    spacing = DEFAULT_SPACING * max(map(min, sizes)) if stock.spacing is None else stock.spacing
    room = stock.room if stock.sheet is not None else _roll(sizes, spacing)
    places = nest(sizes, room, spacing, turn=stock.grain is None)
    sheets = [place.sheet for place in places]
    angles = [0.5 * np.pi if place.turned else 0.0 for place in places]
    shifts = [np.array([place.x + (sizes[k][1] if place.turned else 0.0), place.y]) for k, place in enumerate(places)]
    if outlines:
        sheets, found = nest_shapes(outlines, sheets, room, spacing, turn=stock.grain is None)
        for piece, position in found.items():
            angles[piece], shifts[piece] = position
    used = []
    for number in range(1 + max(sheets)):
        inside = [k for k, sheet in enumerate(sheets) if sheet == number]
        smaller = _smaller(stock, [sizes[k] for k in inside], spacing)
        used.append(stock.sheet if smaller is None else smaller[0])
        for k, place in zip(inside, smaller[1] if smaller else ()):
            angles[k] = 0.5 * np.pi if place.turned else 0.0
            shifts[k] = np.array([place.x + (sizes[k][1] if place.turned else 0.0), place.y])
    plane = np.empty_like(own.plane)
    for piece, corners in enumerate(turned):
        c, s = np.cos(angles[piece]), np.sin(angles[piece])
        plane[own.piece == piece] = corners @ np.array([[c, s], [-s, c]]) + shifts[piece] + stock.margin
    return Placed(replace(own, plane=plane), sheets, [size for size in used if size is not None], stock._replace(spacing=spacing))


def _smaller(stock: Stock, sizes: list[tuple[float, float]], spacing: float) -> Optional[tuple[tuple[float, float], list[Place]]]:
    """Return the smallest sheet that holds some rectangles, and their places; None if only the largest does."""
    for sheet in stock.smaller:
        try:
            places = nest(sizes, stock.inside(sheet), spacing, turn=stock.grain is None)
        except ValueError:
            continue
        if all(place.sheet == 0 for place in places):
            return sheet, places
    return None


def _roll(sizes: list[tuple[float, float]], spacing: float) -> tuple[float, float]:
    """Return a roughly square sheet with room for all pieces [L]."""
    side = max(max(max(size) for size in sizes), 1.2 * float(np.sqrt(sum(length * width for length, width in sizes))))
    return side, sum(max(size) + spacing for size in sizes)
