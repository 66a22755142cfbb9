"""Placing: pieces turned and shifted to their places on sheets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..discrete.arrays import FloatArray
from .allowance import reach
from .nesting import nest
from .outlines import outline_loops
from .patchwork import Patchwork
from .pieces import best_box
from .stock import KERF
from .stock import Stock

__all__ = ["extent", "on_sheets"]


def extent(own: Patchwork, piece: int, allowance: float) -> FloatArray:
    """Return points (k, 2) around what a piece takes of a sheet, with the strip around it [L]."""
    faces = own.piece == piece
    if not allowance:
        return own.plane[faces].reshape(-1, 2)
    parts = {name: getattr(own, name)[faces] for name in ("faces", "plane", "side", "region", "parent")}
    alone = replace(own, **parts, piece=np.zeros(int(faces.sum()), np.int64))
    return reach([loop.points for loop in outline_loops(alone)[0]], allowance)


def on_sheets(own: Patchwork, stock: Stock) -> tuple[Patchwork, list[int], Stock]:
    """Turn and shift the pieces to their places inside of the margins, and return the sheet of each, and how far they are apart."""
    turned, sizes = [], []
    for piece in range(int(own.piece.max()) + 1):
        taken = extent(own, piece, stock.allowance)
        along = best_box(taken, stock.room).along
        turn = np.column_stack([along, [-along[1], along[0]]])
        low = (taken @ turn).min(axis=0)
        turned.append(own.plane[own.piece == piece] @ turn - low)
        sizes.append(tuple(np.ptp(taken @ turn, axis=0).tolist()))
    spacing = KERF * max(map(min, sizes)) if stock.spacing is None else stock.spacing
    places = nest(sizes, stock.room if stock.sheet is not None else _roll(sizes, spacing), spacing)
    plane = np.empty_like(own.plane)
    for piece, place in enumerate(places):
        corners = turned[piece]
        if place.turned:
            corners = corners @ np.array([[0.0, 1.0], [-1.0, 0.0]]) + [sizes[piece][1], 0.0]
        plane[own.piece == piece] = corners + [place.x + stock.margin, place.y + stock.margin]
    return replace(own, plane=plane), [place.sheet for place in places], stock._replace(spacing=spacing)


def _roll(sizes: list[tuple[float, float]], spacing: float) -> tuple[float, float]:
    """Return a sheet that has room for all pieces, about square [L]."""
    side = max(max(max(size) for size in sizes), 1.2 * float(np.sqrt(sum(length * width for length, width in sizes))))
    return side, sum(max(size) + spacing for size in sizes)
