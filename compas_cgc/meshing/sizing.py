"""Size field: how long edges should be where, graded from small features to the length aimed at."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from ..discrete.arrays import FloatArray
from ..discrete.plan import flattened
from .polyline import arc_lengths

__all__ = ["SizeField", "size_field"]

TURN = 0.5  # most that a curve turns along an edge [rad]
AROUND = 12  # edges of a closed curve without kinks at least
KINK = np.radians(30.0)
BASE = 1.4  # times the distance of a point from a curve, that edges are long there: a triangle with that height has even angles
CHUNK = 64  # sources at a time
SMALLEST = 0.12  # of the edge length
NARROWEST = 0.02  # of the edge length, in a gap between curves
ONE = 0.1  # of the edge length, within which a node is on a curve
MEETING = 0.25  # of the edge length from a crossing, within which curves are near because they meet
BESIDE = np.array([-4.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 4.0])  # times a gap, from where it is narrowest: so closely it is measured
ALONG = 4.0  # times the root of a gap and the edge length, from where it is narrowest: so far it is measured


class SizeField:
    """Edge lengths: those of the sources, and longer with the distance from them.

    Parameters
    ----------
    edge_length
        The longest [L].
    sources
        ``(k, 2)`` places of small features [L].
    sizes
        ``(k,)`` edge lengths there [L].
    grade
        Part of the distance from a small feature by which edges grow.
    """

    def __init__(self, edge_length: float, sources: FloatArray, sizes: FloatArray, grade: float):
        self.edge_length, self._grade = edge_length, grade
        self._small = np.unique(np.column_stack([sources, sizes])[sizes < 0.95 * edge_length], axis=0)
        # Sources in the reach of smaller ones say nothing, and cost time.
        self._small = self._small[self._small[:, 2] <= self(self._small[:, :2])]

    @property
    def graded(self) -> bool:
        """Whether edges are shorter anywhere."""
        return len(self._small) > 0

    @property
    def smallest(self) -> float:
        """The shortest edge length [L]."""
        return float(self._small[:, 2].min(initial=self.edge_length))

    def __call__(self, points: FloatArray) -> FloatArray:
        """Return the edge lengths (n,) at points (n, 2)."""
        found = np.full(len(points), self.edge_length)
        for few in np.array_split(self._small, len(self._small) // CHUNK + 1):
            found = np.minimum(found, (few[:, 2] + self._grade * cdist(points, few[:, :2])).min(axis=1, initial=self.edge_length))
        return found


def size_field(
    lines: Sequence[FloatArray],
    sides: Sequence[FloatArray],
    domain: shapely.Polygon,
    nodes: FloatArray,
    points: FloatArray,
    edge_length: float,
    grade: float,
) -> SizeField:
    """Return the size field of curves and points.

    Parameters
    ----------
    lines
        ``(k, 2)`` points along each curve [L].
    sides
        ``(k, 2)`` points along their parts that turn by a quarter at most, between which gaps are measured [L].
    domain
        What is to be filled.
    nodes
        ``(k, 2)`` places on the curves that become vertices [L].
    points
        ``(k, 2)`` places between the curves that do [L].
    edge_length
        The longest [L].
    grade
        Part of the distance from a small feature by which edges grow.
    """
    sources, sizes = [], []
    for line in lines:
        place, size = _bends(line, edge_length)
        sources.append(place)
        sizes.append(size)
    every = np.concatenate([nodes, points])
    if len(every) > 1:
        gap = cKDTree(every).query(every, k=2)[0][:, 1]
        sources.append(every)
        sizes.append(gap)
    if len(points):
        curves = shapely.MultiLineString([shapely.LineString(line) for line in lines])
        sources.append(points)
        sizes.append(BASE * shapely.distance(curves, shapely.points(points)))
    narrows, gaps = _narrows(sides, domain, nodes, edge_length)
    smallest = np.maximum(np.concatenate(sizes), SMALLEST * edge_length)
    return SizeField(
        edge_length,
        np.concatenate([*sources, narrows]),
        np.concatenate([smallest, np.maximum(BASE * gaps, NARROWEST * edge_length)]),
        grade,
    )


def _narrows(sides: Sequence[FloatArray], domain: shapely.Polygon, nodes: FloatArray, edge_length: float) -> tuple[FloatArray, FloatArray]:
    """Return places (k, 2) where a side passes close by another one without meeting it, and the gaps (k,) there [L]."""
    curves = [shapely.LineString(side) for side in sides]
    places, gaps = [np.empty((0, 2))], [np.empty(0)]
    corners: Any = shapely.points(nodes.reshape(-1, 2))
    for k, j in shapely.STRtree(curves).query(curves, predicate="dwithin", distance=edge_length).T.tolist():
        if k != j:
            shared = corners[np.maximum(*(shapely.distance(curves[i], corners) for i in (k, j))) <= ONE * edge_length]
            met = shapely.union_all([curves[k].intersection(curves[j]), *shared])
            place, gap = _gap(curves[k], curves[j], met, domain, edge_length)
            places.append(place)
            gaps.append(gap)
    return np.concatenate(places), np.concatenate(gaps)


def _gap(
    curve: shapely.LineString, other: shapely.LineString, met: shapely.Geometry, domain: shapely.Polygon, edge_length: float
) -> tuple[FloatArray, FloatArray]:
    """Return places along a curve, around those where another one that it meets elsewhere is nearest, and the gaps there [L]."""
    step = curve.length / max(2, int(np.ceil(8 * curve.length / edge_length)))
    even = np.arange(round(curve.length / step) + 1) * step
    gap = shapely.distance(shapely.line_interpolate_point(curve, even), other)
    beyond = np.concatenate([[np.inf], gap, [np.inf]]) * (1.0 + 1e-9)
    nearest = np.flatnonzero((gap <= beyond[:-2]) & (gap <= beyond[2:]) & (gap < edge_length))
    beside = gap[nearest, None] * BESIDE
    far = ALONG * np.sqrt(gap[nearest] * edge_length)
    around = (np.abs(even[:, None] - even[nearest]) <= far).any(axis=1)
    t = np.concatenate([(even[nearest, None] + beside)[np.abs(beside) < step], even[around]])
    spots = shapely.line_interpolate_point(curve, np.unique(t[(t >= 0.0) & (t <= curve.length)]))
    gap = shapely.distance(spots, other)
    # Towards a crossing it falls to nothing; the narrow corner there is a matter of its own.
    apart = ~(shapely.distance(spots, met) <= MEETING * edge_length) & (gap > 0.0) & (gap < edge_length)
    spots, gap = spots[apart], gap[apart]
    across = shapely.line_interpolate_point(shapely.shortest_line(spots, other), 0.5, normalized=True)
    inside = shapely.contains(domain, across)
    return shapely.get_coordinates(spots[inside]), gap[inside]


def _bends(line: FloatArray, edge_length: float) -> tuple[FloatArray, FloatArray]:
    """Return places along a curve and the edge lengths that its bends ask for there."""
    at = arc_lengths(flattened(line))
    ahead = np.diff(line, axis=0)
    turn = np.abs(np.angle(np.exp(1j * np.diff(np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))))))
    # Kinks are corners, not bends.
    turned = np.concatenate([[0.0], np.cumsum(np.where(turn < KINK, turn, 0.0)), [0.0]])
    turned[-1] = turned[-2]
    number = max(2, int(np.ceil(4 * at[-1] / edge_length)))
    t = np.linspace(0.0, at[-1], number + 1)
    half = 0.5 * edge_length
    window = np.minimum(t + half, at[-1]) - np.maximum(t - half, 0.0)
    rate = (np.interp(t + half, at, turned) - np.interp(t - half, at, turned)) / np.maximum(window, 1e-300)
    size = TURN / np.maximum(rate, 1e-12)
    if (line[0] == line[-1]).all() and (turn < KINK).all():
        size = np.minimum(size, at[-1] / AROUND)
    return np.column_stack([np.interp(t, at, line[:, k]) for k in range(2)]), size
