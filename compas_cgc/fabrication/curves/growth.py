"""Choice of curves to trace: through points, or a net grown from the centre of a region."""

from __future__ import annotations

from typing import Optional

import numpy as np
from scipy.spatial import cKDTree

from ...discrete.arrays import IntArray
from ...discrete.arrays import Vectors
from .crossings import arc_lengths_of
from .crossings import bow_of
from .crossings import is_closed
from .crossings import is_long
from .crossings import meetings
from .crossings import place_at
from .stop_distance import Neighbours
from .trace import CURVATURE
from .trace import RULING
from .trace import DirectionField
from .trace import Traced
from .trace import trace

__all__ = ["curves_through", "grown_net"]

MIN_CROSSING_DISTANCE = 0.5  # relative to the spacing; two curves must not cross a third one nearer to each other
MAX_BOW = 0.05  # bow over chord up to which a curve that fills a gap counts as a ruling
GAP_TOLERANCE = 0.5  # excess over the spacing, relative to it, above which a gap between crossings gets a curve
MAX_CURVES = 2000  # per region


def curves_through(field: DirectionField, kind: int, points: Vectors, supports: Optional[IntArray]) -> list[list[Traced]]:
    """Return curves traced through points, or from supports (starting just inside)."""
    if supports is not None:
        points = field.vertices[supports]
    centres = field.vertices[field.faces].mean(axis=1)
    used = field.vertices[np.unique(field.faces)]
    traced: list[list[Traced]] = [[], []]
    for point in points:
        near = int(np.argmin(np.linalg.norm(centres - point, axis=1)))
        edge = np.linalg.norm(field.vertices[field.faces[near, 0]] - field.vertices[field.faces[near, 1]])
        if np.linalg.norm(used - point, axis=1).min() > 2.0 * edge:
            continue  # The point belongs to another region.
        face, place = _nearest(field, point)
        for family in (0,) if kind == RULING else (0, 1):
            curve = trace(field, kind, family, face, place)
            if len(curve.points) > 1:
                traced[family].append(curve)
    return traced


def _nearest(field: DirectionField, point: Vectors) -> tuple[int, Vectors]:
    """Return the nearest face to a point, and the nearest point in its interior."""
    corners = field.vertices[field.faces]
    middle = corners.mean(axis=1)
    near = np.argsort(np.linalg.norm(middle - point, axis=1))[:24]
    best = (np.inf, int(near[0]), middle[near[0]])
    for face in near.tolist():
        a, b, c = corners[face]
        system = np.column_stack([b - a, c - a])
        s, t = np.linalg.lstsq(system, point - a, rcond=None)[0]
        weights = np.clip([1.0 - s - t, s, t], 1e-3, None)
        place = weights / weights.sum() @ corners[face]
        away = float(np.linalg.norm(place - point))
        if away < best[0]:
            best = (away, face, place)
    return best[1], best[2]


class _Growth:
    """A growing net: its curves by family, and the crossings on each."""

    def __init__(self, field: DirectionField, spacing: float, stop: float):
        self.field, self.spacing = field, spacing
        self.neighbours = Neighbours(spacing, stop)
        self.curves: list[list[Traced]] = [[], []]
        self.crossed: list[list[list[float]]] = [[], []]  # arc lengths, by family and curve

    def add(self, family: int, curve: Traced) -> list[tuple[int, int]]:
        """Add a curve, and return (family, number) of it and of the curves that it crosses."""
        number = len(self.curves[family])
        touched = [(family, number)]
        own: list[float] = []
        for i, other in enumerate(self.curves[1 - family]):
            met = meetings(self.field, curve, other)
            own += [s for s, _ in met]
            self.crossed[1 - family][i] += [t for _, t in met]
            if met:
                touched.append((1 - family, i))
        self.curves[family].append(curve)
        self.crossed[family].append(own)
        self.neighbours.add(curve)
        return touched

    def uncrowded(self, family: int, new: Traced, place: Vectors) -> Traced:
        """Return the part of a new curve around `place` that keeps its distance from existing curves; it may be empty."""
        new = self.neighbours.clear_part(new, place)
        if len(new.points) < 2:
            return new
        at = arc_lengths_of(new)
        mark = float(at[np.argmin(np.linalg.norm(new.points - place, axis=1))])
        low, high = -np.inf, np.inf
        for curve, there in zip(self.curves[1 - family], self.crossed[1 - family]):
            for s, own in meetings(self.field, curve, new) if there else ():
                if min(_apart(curve, s, t) for t in there) < MIN_CROSSING_DISTANCE * self.spacing:
                    if abs(own - mark) < 0.1 * self.spacing:
                        return Traced(new.points[:1], new.faces[:0])
                    low, high = (max(low, own), high) if own < mark else (low, min(high, own))
        kept = np.flatnonzero((at > low) & (at < high))
        return Traced(new.points[kept], new.faces[kept[:-1]])


def grown_net(field: DirectionField, kind: int, spacing: float, size: float, stop: float) -> list[list[Traced]]:
    """Return a traced net: two curves through the centre, then further ones from marks along every curve.

    Lines of curvature end where they come nearer to each other than `stop` times the spacing.
    """
    centres = field.vertices[field.faces].mean(axis=1)
    face = _first_face(field, kind, centres, size)
    growth = _Growth(field, spacing, stop if kind == CURVATURE else 0.0)
    # For rulings only the first curve across them gets marks.
    for family in (0, 1):
        curve = trace(field, kind, family, face, centres[face])
        if len(curve.points) < 2:
            return [[], []]
        growth.add(family, curve)
    waiting = [(1, 0)] if kind == RULING else [(0, 0), (1, 0)]
    tried = set()
    while waiting and sum(map(len, growth.curves)) < MAX_CURVES:
        family, number = waiting.pop(0)
        curve = growth.curves[family][number]
        for mark in _open_marks(curve, growth.crossed[family][number], spacing, kind == CURVATURE):
            key = (family, number, round(mark / spacing, 3))
            if key in tried:
                continue
            tried.add(key)
            start, place = place_at(curve, arc_lengths_of(curve), mark)
            new = growth.uncrowded(1 - family, trace(field, kind, 1 - family, start, place), place)
            if is_long(new, spacing):
                touched = growth.add(1 - family, new)
                waiting += [] if kind == RULING else [each for each in touched if each not in waiting]
    return [_filled(field, growth.curves[0], centres, spacing), []] if kind == RULING else growth.curves


def _filled(field: DirectionField, curves: list[Traced], centres: Vectors, spacing: float) -> list[Traced]:
    """Return rulings with further ones where none is within a spacing, as in fans beyond the first crossing curve."""
    away = cKDTree(np.vstack([curve.points for curve in curves])).query(centres)[0]
    found = list(curves)
    while away.max() > spacing and len(found) < MAX_CURVES:
        face = int(np.argmax(away))
        curve = trace(field, RULING, 0, face, centres[face])
        away[face] = 0.0
        if is_long(curve, spacing) and bow_of(curve.points) < MAX_BOW:
            found.append(curve)
            away = np.minimum(away, cKDTree(curve.points).query(centres)[0])
    return found


def _first_face(field: DirectionField, kind: int, centres: Vectors, size: float) -> int:
    """Return the first face: the central one, or for lines of curvature a central one with distinct principal curvatures."""
    away = np.linalg.norm(centres - centres.mean(axis=0), axis=1)
    if kind != CURVATURE:
        return int(np.argmin(away))
    S = field.operators[field.faces].mean(axis=1)
    trace_, square = np.trace(S, axis1=1, axis2=2), np.einsum("fij,fij->f", S, S)
    spread = np.maximum(2.0 * square - trace_**2, 0.0)
    return int(np.argmax(np.where(away <= max(0.25 * size, away.min()), spread, -1.0)))


def _open_marks(curve: Traced, crossed: list[float], spacing: float, between: bool) -> list[float]:
    """Return marks at the spacing beyond the outermost crossings of a curve and, with `between`, in gaps."""
    if not crossed:
        return []
    length = float(arc_lengths_of(curve)[-1])
    crossed = sorted(crossed)
    if between and is_closed(curve):
        # On a closed curve the gap across its start counts like the others.
        return [mark % length for mark in _between([*crossed, crossed[0] + length], spacing)]
    marks = [*np.arange(crossed[-1] + spacing, length, spacing).tolist(), *np.arange(crossed[0] - spacing, 0.0, -spacing).tolist()]
    return marks + (_between(crossed, spacing) if between else [])


def _apart(curve: Traced, s: float, t: float) -> float:
    """Return the distance along a curve between two arc lengths, the shorter one on a closed curve [L]."""
    return min(abs(s - t), float(arc_lengths_of(curve)[-1]) - abs(s - t)) if is_closed(curve) else abs(s - t)


def _between(crossed: list[float], spacing: float) -> list[float]:
    """Return evenly spaced marks in gaps between crossings."""
    marks = []
    for s, t in zip(crossed[:-1], crossed[1:]):
        count = int((t - s) / spacing + 1.0 - GAP_TOLERANCE)
        marks += [s + (t - s) * k / (count + 1) for k in range(1, count + 1)]
    return marks
