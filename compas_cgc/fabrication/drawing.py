"""Drawings as lines and texts by layer, independent of file formats."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from .figures import metres

__all__ = [
    "LAYERS",
    "LETTER_WIDTH",
    "Drawing",
    "Line",
    "Text",
    "clearance",
    "inside",
    "overlap",
    "roomiest",
    "segment_distances",
    "square_room",
    "text_box",
]

# Layers with their RGB colours.
LAYERS = {
    "SHEET": (150, 150, 150),
    "CUT": (200, 30, 30),
    "OUTLINE": (20, 130, 140),
    "FOLD_UP": (30, 80, 200),
    "FOLD_DOWN": (150, 40, 160),
    "RULING": (40, 150, 70),
    "MARK": (230, 140, 20),
    "LABEL": (30, 30, 30),
    "SEAM": (230, 140, 20),
    "NODE": (120, 120, 120),
    "FAMILY_0": (30, 80, 200),
    "FAMILY_1": (200, 30, 30),
    "LEGEND": (30, 30, 30),
}
LETTER_WIDTH = 0.8  # relative to its height
MAX_PLACES = 200  # points that are compared
GRID = 14  # points along the larger side of an outline at which labels are tried
ROOM_RATIO = 0.9  # accepted room for a label, relative to the largest


class Line(NamedTuple):
    """A polyline."""

    layer: str
    points: FloatArray  # (k, 2) [L]
    closed: bool = False


class Text(NamedTuple):
    """A line of text, centred at a point or starting there."""

    layer: str
    text: str
    place: FloatArray  # (2,) [L]
    height: float  # [L]
    colour: str = ""  # layer whose colour it has; its own if empty
    starts: bool = False  # whether it starts at the point


class Drawing(NamedTuple):
    """All sheets side by side."""

    lines: list[Line]
    texts: list[Text]
    size: tuple[float, float]  # from the origin [L]
    units: Optional[str]  # such as ``Meters``

    def within(self, units: str) -> Drawing:
        """Return the drawing in other units, such as ``Millimeters``."""
        scale = metres(self.units) / metres(units)
        lines = [line._replace(points=scale * line.points) for line in self.lines]
        texts = [text._replace(place=scale * text.place, height=scale * text.height) for text in self.texts]
        return Drawing(lines, texts, (scale * self.size[0], scale * self.size[1]), units)

    def moved(self, by: Sequence[float]) -> Drawing:
        """Return the drawing with its lines and texts moved by (2,) [L]."""
        lines = [line._replace(points=line.points + by) for line in self.lines]
        return self._replace(lines=lines, texts=[text._replace(place=text.place + by) for text in self.texts])


def roomiest(centres: FloatArray, loops: Sequence[FloatArray], text: str) -> tuple[FloatArray, float]:
    """Return the best of some points (p, 2) for a text, near the middle, and the height at which it touches the outlines [L]."""
    centres = centres[:: max(1, len(centres) // MAX_PLACES)]
    start = np.concatenate(loops)
    end = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
    half = 0.5 * np.array([LETTER_WIDTH * len(text), 1.0])
    room = square_room(centres / half, np.stack([start, end], axis=1) / half)
    off = np.linalg.norm(centres - 0.5 * (start.min(axis=0) + start.max(axis=0)), axis=1)
    best = int(np.argmin(np.where(room >= ROOM_RATIO * room.max(), off, np.inf)))
    return centres[best], float(room[best])


def square_room(places: FloatArray, segments: FloatArray) -> FloatArray:
    """Return half the side of the largest square around places (p, 2) that no segment (k, 2, 2) enters (p,)."""
    start, along = segments[:, 0] - places[:, None], segments[:, 1] - segments[:, 0]
    # Along a segment the larger coordinate is smallest at an end, on an axis or on a diagonal.
    with np.errstate(divide="ignore", invalid="ignore"):
        on = [-(start @ normal) / (along @ normal) for normal in np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0]])]
    shares = np.clip(np.nan_to_num([*on, np.zeros_like(on[0]), np.ones_like(on[0])]), 0.0, 1.0)
    return np.asarray(np.abs(start + shares[..., None] * along).max(axis=3).min(axis=(0, 2)), dtype=np.float64)


def segment_distances(points: FloatArray, segments: FloatArray) -> FloatArray:
    """Return the distances of points (p, 2) from segments (k, 2, 2): (p, k) [L]."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    from_start = points[:, None] - start
    share = np.einsum("pkj,kj->pk", from_start, along) / np.maximum(np.einsum("kj,kj->k", along, along), np.finfo(float).tiny)
    return np.linalg.norm(from_start - np.clip(share, 0.0, 1.0)[..., None] * along, axis=2)


def inside(loops: Sequence[FloatArray]) -> FloatArray:
    """Return points of a square grid inside closed loops (k, 2), by the even-odd rule (p, 2) [L]; none if they enclose no area."""
    start = np.concatenate(loops)
    end = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
    low, high = start.min(axis=0), start.max(axis=0)
    step = float((high - low).max()) / GRID
    if not step > 0.0:
        return np.empty((0, 2))
    x, y = (np.arange(0.5, np.ceil(side / step)) * step for side in high - low)
    points = low + np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    rise = end[:, 1] - start[:, 1]
    spans = (start[:, 1] <= points[:, 1:]) != (end[:, 1] <= points[:, 1:])
    share = (points[:, 1:] - start[:, 1]) / np.where(rise == 0.0, 1.0, rise)
    right = start[:, 0] + share * (end[:, 0] - start[:, 0]) > points[:, :1]
    return points[(spans & right).sum(axis=1) % 2 == 1]


def text_box(text: str, place: FloatArray, size: float) -> FloatArray:
    """Return the lower left and upper right corner of a text centred at a place (2, 2) [L]."""
    half = 0.5 * size * np.array([LETTER_WIDTH * len(text), 1.0])
    return np.array([place - half, place + half])


def overlap(box: FloatArray, other: FloatArray) -> bool:
    """Check whether two boxes (2, 2) overlap."""
    return bool((box[0] < other[1]).all() and (other[0] < box[1]).all())


def clearance(text: str, size: float, direction: FloatArray) -> float:
    """Return the distance of the middle of a text from a line perpendicular to `direction` at which they do not overlap [L]."""
    return 0.5 * LETTER_WIDTH * size * len(text) * abs(float(direction[0])) + 0.5 * size * abs(float(direction[1])) + 0.4 * size
