"""Painter's algorithm: hidden surface removal by painting the farthest polygons first."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import NamedTuple
from typing import Union

import numpy as np

from .._figures import matplotlib_module
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..meshing.visibility import in_sight
from .colours import rgba

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Layer", "discs", "face_nearness", "layer", "paint", "segments"]


Colours = Union[str, tuple[float, float, float, float], FloatArray]
"""One colour by name or as RGBA, or ``(k, 4)`` one RGBA colour per polygon."""

PIECES = 4  # number of pieces of a partly hidden edge


class Layer(NamedTuple):
    """Polygons of one kind; at equal depth, later layers are painted on top."""

    polygons: FloatArray  # (k, c, 2) projected corners [L]
    nearness: FloatArray  # (k,) larger is nearer [L]
    fill: FloatArray  # (k, 4) colours
    edge: FloatArray  # (k, 4) colours
    width: FloatArray  # (k,) line width of the edges [pt]


def layer(polygons: FloatArray, nearness: FloatArray, fill: Colours, edge: Colours, width: float) -> Layer:
    """Return a layer from one colour, or one colour per polygon."""
    k = len(polygons)
    fills, edges = (np.broadcast_to(rgba(colour) if isinstance(colour, str) else colour, (k, 4)) for colour in (fill, edge))
    return Layer(polygons, nearness, fills, edges, np.full(k, float(width)))


def paint(ax: Axes, layers: list[Layer]) -> None:
    """Paint layers on axes, the farthest polygon first."""
    polygons = [polygon for one in layers for polygon in one.polygons]
    nearness, fill, edge, width = (np.concatenate([one[i] for one in layers]) for i in range(1, 5))
    order = np.argsort(nearness, kind="stable")
    collection = matplotlib_module("collections").PolyCollection(
        [polygons[i] for i in order],
        facecolors=fill[order],
        edgecolors=edge[order],
        linewidths=width[order],
        joinstyle="round",
        capstyle="round",
    )
    ax.add_collection(collection, autolim=False)


def face_nearness(nearness: FloatArray, faces: IntArray) -> FloatArray:
    """Return the nearness of the centre of every face (m,)."""
    return nearness[faces].mean(axis=1)


def segments(corners: FloatArray, faces: IntArray, edges: IntArray, colour: str, width: float) -> Layer:
    """Return the visible parts of edges ``(e, 2)`` between projected vertices ``(n, 3)``, as lines in front of everything."""
    steps = np.linspace(0.0, 1.0, PIECES + 1)[:, None]
    ends = corners[edges]
    cuts = ends[:, :1] * (1.0 - steps) + ends[:, 1:] * steps
    pieces = np.stack([cuts[:, :-1], cuts[:, 1:]], axis=2).reshape(-1, 2, 3)
    pieces = pieces[in_sight(pieces.mean(axis=1), corners, faces)]
    return layer(pieces[..., :2], np.full(len(pieces), np.inf), "none", colour, width)


def discs(corners: FloatArray, faces: IntArray, which: IntArray, radius: float, colour: str) -> Layer:
    """Return discs of a radius [L] at the visible vertices, in front of everything."""
    angle = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
    circle = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    seen = which[in_sight(corners[which], corners, faces)]
    return layer(corners[seen, None, :2] + circle, np.full(len(seen), np.inf), colour, "white", 0.25)
