"""Crossings of traced curves, and the net that they form."""

from __future__ import annotations

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Vectors
from ..patchwork import pairs_of_equal
from .trace import DirectionField
from .trace import Traced

__all__ = ["arc_lengths_of", "bow_of", "crossings", "is_closed", "is_long", "meetings", "place_at"]

MIN_LENGTH = 0.05  # relative to the spacing; shorter curves are dropped


def meetings(field: DirectionField, one: Traced, other: Traced) -> list[tuple[float, float]]:
    """Return the arc lengths of both curves at their crossings."""
    common, first, second = pairs_of_equal(one.faces, other.faces)
    if not len(common):
        return []
    origin, axes = field.vertices[field.faces[common, 0]], field.axes[common]

    def flat(points: Vectors) -> FloatArray:
        return np.einsum("kij,kj->ki", axes, points - origin)

    a, b = flat(one.points[first]), flat(one.points[first + 1])
    c, d = flat(other.points[second]), flat(other.points[second + 1])
    u, v, w = b - a, d - c, c - a
    across = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    safe = np.where(across == 0.0, 1.0, across)
    s = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / safe
    t = (w[:, 0] * u[:, 1] - w[:, 1] * u[:, 0]) / safe
    slack = 1e-9
    met = (across != 0.0) & (s >= -slack) & (s <= 1.0 + slack) & (t >= -slack) & (t <= 1.0 + slack)
    at, there = arc_lengths_of(one), arc_lengths_of(other)
    found: list[tuple[float, float]] = []
    for k in np.flatnonzero(met).tolist():
        i, j = first[k], second[k]
        place = (float(at[i] + s[k] * (at[i + 1] - at[i])), float(there[j] + t[k] * (there[j + 1] - there[j])))
        # At a mesh edge two pairs of segments share one crossing.
        if not any(abs(place[0] - old[0]) < 1e-6 * at[-1] for old in found):
            found.append(place)
    return found


def crossings(field: DirectionField, traced: list[list[Traced]]) -> tuple[Vectors, IntArray, FloatArray]:
    """Return the nodes of a net (k, 3), the sides between them (s, 2), and their lengths along the curves (s,)."""
    nodes: list[Vectors] = []
    on_first: dict[int, list[tuple[float, int]]] = {}
    on_second: dict[int, list[tuple[float, int]]] = {}
    for i, one in enumerate(traced[0]):
        for j, other in enumerate(traced[1]):
            for s, t in meetings(field, one, other):
                number = len(nodes)
                nodes.append(place_at(one, arc_lengths_of(one), s)[1])
                on_first.setdefault(i, []).append((s, number))
                on_second.setdefault(j, []).append((t, number))
    sides, lengths = [], []
    for marks in [*on_first.values(), *on_second.values()]:
        marks.sort()
        for (s, a), (t, b) in zip(marks[:-1], marks[1:]):
            sides.append((a, b))
            lengths.append(t - s)
    return np.array(nodes).reshape(-1, 3), np.array(sides, dtype=np.int64).reshape(-1, 2), np.array(lengths)


def arc_lengths_of(curve: Traced) -> FloatArray:
    """Return the arc lengths of the points of a curve (k,) [L]."""
    return np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(curve.points, axis=0), axis=1))]


def is_closed(curve: Traced) -> bool:
    """Check whether a curve is closed."""
    return len(curve.points) > 2 and np.array_equal(curve.points[0], curve.points[-1])


def is_long(curve: Traced, spacing: float) -> bool:
    """Check whether a curve is long enough to keep, at a spacing [L]."""
    return len(curve.points) > 1 and float(arc_lengths_of(curve)[-1]) > MIN_LENGTH * spacing


def bow_of(points: Vectors) -> float:
    """Return the largest distance of points (k, 3) from their chord, relative to its length."""
    chord = points[-1] - points[0]
    away = points - points[0]
    # A closed curve has no chord.
    span = max(float(np.linalg.norm(chord)), 1e-9 * float(np.abs(away).max()), 1e-100)
    return float(np.linalg.norm(away - np.outer(away @ chord, chord) / span**2, axis=1).max()) / span


def place_at(curve: Traced, at: FloatArray, mark: float) -> tuple[int, Vectors]:
    """Return the face and the point (3,) at arc length `mark`, given the arc lengths of the points (k,) [L]."""
    k = int(np.clip(np.searchsorted(at, mark) - 1, 0, len(curve.faces) - 1))
    share = (mark - at[k]) / max(at[k + 1] - at[k], np.finfo(float).tiny)
    return int(curve.faces[k]), (1.0 - share) * curve.points[k] + share * curve.points[k + 1]
