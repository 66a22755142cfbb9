"""Placing of pieces on sheets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..discrete.arrays import FloatArray
from .allowance import reach
from .nesting import nest
from .outlines import outline_loops
from .patchwork import Patchwork
from .pieces import best_box
from .stock import DEFAULT_SPACING
from .stock import Stock

__all__ = ["extent", "on_sheets"]


def extent(own: Patchwork, piece: int, allowance: float) -> FloatArray:
    """Return points (k, 2) around a piece with its allowance [L]."""
    faces = own.piece == piece
    if not allowance:
        return own.plane[faces].reshape(-1, 2)
    parts = {name: getattr(own, name)[faces] for name in ("faces", "plane", "side", "region", "parent")}
    alone = replace(own, **parts, piece=np.zeros(int(faces.sum()), np.int64))
    return reach([loop.points for loop in outline_loops(alone)[0]], allowance)


def on_sheets(own: Patchwork, stock: Stock) -> tuple[Patchwork, list[int], Stock]:
    """Return the patchwork with its pieces placed on sheets, the sheet of each piece, and the stock with its spacing."""
    turned, sizes = [], []
    for piece in range(int(own.piece.max()) + 1):
        taken = extent(own, piece, stock.allowance)
        along = best_box(taken, stock.room).along
        turn = np.column_stack([along, [-along[1], along[0]]])
        low = (taken @ turn).min(axis=0)
        turned.append(own.plane[own.piece == piece] @ turn - low)
        sizes.append(tuple(np.ptp(taken @ turn, axis=0).tolist()))
    spacing = DEFAULT_SPACING * max(map(min, sizes)) if stock.spacing is None else stock.spacing
    places = nest(sizes, stock.room if stock.sheet is not None else _roll(sizes, spacing), spacing)
    plane = np.empty_like(own.plane)
    for piece, place in enumerate(places):
        corners = turned[piece]
        if place.turned:
            corners = corners @ np.array([[0.0, 1.0], [-1.0, 0.0]]) + [sizes[piece][1], 0.0]
        plane[own.piece == piece] = corners + [place.x + stock.margin, place.y + stock.margin]
    return replace(own, plane=plane), [place.sheet for place in places], stock._replace(spacing=spacing)


def _roll(sizes: list[tuple[float, float]], spacing: float) -> tuple[float, float]:
    """Return a roughly square sheet with room for all pieces [L]."""
    side = max(max(max(size) for size in sizes), 1.2 * float(np.sqrt(sum(length * width for length, width in sizes))))
    return side, sum(max(size) + spacing for size in sizes)
