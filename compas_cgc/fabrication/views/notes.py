"""Texts of the plan on regions and supports, and the legend of the sheet."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...discrete.arrays import FloatArray
from ..drawing import square_room
from .marks import TEXT_HEIGHT
from .marks import Label
from .marks import letters

if TYPE_CHECKING:
    from .projections import Shape

__all__ = ["legend", "region_labels", "support_heights"]

SMALL = 0.8 * TEXT_HEIGHT  # height of these texts [mm]
LEGEND_SIZES = (2.0, 1.8, 1.6, 1.4, 1.2)  # heights of the texts of the legend, the first that fits [mm]
LEGEND_PITCH = 1.5  # distance of the rows of the legend, relative to their height
ROWS_PITCH = 1.6  # distance of the two rows of a region, relative to their height
ROOM_RATIO = 0.98  # of the largest possible height of a label, above which its place is chosen near the middle of the region
BESIDE = 2.2  # distance of the height of a support from its symbol [mm]
SIDES = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]])


def region_labels(shape: Shape, plan: FloatArray, lines: FloatArray) -> list[Label]:
    """Return the number and the K of every region, in its widest part in plan.

    Parameters
    ----------
    shape
        The surface.
    plan
        ``(n, 2)`` vertices in the plan [mm].
    lines
        ``(k, 2, 2)`` segments of outlines and creases in the plan [mm].
    """
    number = shape.problem.regions()
    centres = plan[shape.faces].mean(axis=1)
    labels = []
    for region, K in enumerate(shape.problem.region_targets()):
        texts = f"region {region}", "K varies" if K is None else f"K = {K + 0.0:.3g}"
        half = np.array([0.5 * max(letters(text, SMALL) for text in texts), ROWS_PITCH * SMALL])
        own = centres[number == region]
        room = np.minimum(square_room(own / half, lines / half), 1.0)
        off = np.linalg.norm(own - own.mean(axis=0), axis=1)
        best = int(np.argmin(np.where(room >= ROOM_RATIO * room.max(), off, np.inf)))
        height, up = SMALL * float(room[best]), np.array([0.0, 0.5 * ROWS_PITCH * SMALL * float(room[best])])
        labels += [Label("REGION", text, own[best] + side * up, height) for text, side in zip(texts, (1.0, -1.0))]
    return labels


def support_heights(shape: Shape, plan: FloatArray, taken: Sequence[Label]) -> list[Label]:
    """Return the heights of single supports and of the ends of supported lines, where there is room beside them.

    Closed lines have the heights of their lowest and highest points. There are no texts if all supports have one height, which the legend
    states.
    """
    if shape.height_of_supports:
        return []
    heights = shape.vertices[:, 2]
    extremes = [path[[np.argmin(heights[path]), np.argmax(heights[path])]] for path in shape.held_lines]
    ends = [path[[0, -1]] if path[0] != path[-1] else both for path, both in zip(shape.held_lines, extremes)]
    at = np.unique(np.concatenate([shape.held_points, *ends]).astype(np.int64))
    texts = [shape.number(height + 0.0) for height in heights[at].tolist()]
    middle, labels = plan[np.unique(shape.faces)].mean(axis=0), list[Label]()
    symbols = plan[shape.held_points]
    for vertex, text in zip(at.tolist(), texts):
        half = 0.5 * np.array([letters(text, SMALL), SMALL])
        away = plan[vertex] - middle
        for side in sorted(SIDES, key=lambda own: -float(own @ away) / float(np.linalg.norm(own))):
            place = plan[vertex] + side * (half + BESIDE)
            others = [(own.place, 0.5 * np.array([letters(own.text, own.height), own.height])) for own in (*taken, *labels)]
            others += [(symbol, np.full(2, 0.5 * BESIDE)) for symbol in symbols]
            if not any((np.abs(place - other) < half + room).all() for other, room in others):
                labels.append(Label("SUPPORT", text, place, SMALL))
                break
    return labels


def legend(shape: Shape, unit: str, size: tuple[float, float]) -> list[Label]:
    """Return the meanings of the lines and numbers of a sheet as rows within a width and height [mm]."""
    height = shape.height_of_supports
    sentences = [
        "black: edges",
        f"blue: {'creases, ' if shape.creases else ''}number and K of every region",
        "brown: contours",
        f"red: supports{f', all at {height}' if height else ' with heights'}" if len(shape.problem.supports) else "",
        "dash-dotted: sections, seen along the arrows",
        "thick: cut",
        "grey: beyond it",
        "beside views: lowest and highest point",
        f"heights: z of the drawing [{unit}]",
        f"K [1/{unit}²]",
    ]
    text, rows, tall = "; ".join(filter(None, sentences)), list[str](), 0.0
    for tall in LEGEND_SIZES:
        rows = textwrap.wrap(text, max(20, int(size[0] / letters("x", tall))))
        if len(rows) * LEGEND_PITCH * tall <= size[1]:
            break
    middle = 0.5 * np.array(size)
    return [Label("TEXT", row, middle + [0.0, (0.5 * (len(rows) - 1) - k) * LEGEND_PITCH * tall], tall) for k, row in enumerate(rows)]
