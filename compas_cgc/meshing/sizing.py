"""Size field: local target edge lengths, graded from small features to the global edge length."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from scipy.spatial import cKDTree

from .._compiled import kernel
from ..discrete.arrays import FloatArray
from ..discrete.plan import flattened
from .polyline import arc_lengths

__all__ = ["SizeField", "size_field"]

MAX_TURN = 0.5  # largest turn of a curve along an edge [rad]
MIN_EDGES = 12  # least number of edges of a smooth closed curve
KINK_ANGLE = np.radians(30.0)
EDGE_OVER_HEIGHT = 1.4  # edge length over the distance between a point and a curve, for triangles of that height
MIN_SIZE = 0.12  # least size relative to the edge length
MIN_GAP_SIZE = 0.02  # least size in a gap between curves, relative to the edge length
NODE_DISTANCE = 0.1  # distance of a node on a curve, relative to the edge length
CROSSING_DISTANCE = 0.25  # distance from a crossing within which gaps are ignored, relative to the edge length
GAP_SAMPLES = np.array(
    [-4.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 4.0]
)  # offsets of samples around the narrowest point of a gap, in gap widths
GAP_REACH = 4.0  # reach of the samples, relative to sqrt(gap * edge length)


class SizeField:
    """Target edge lengths: given at sources and growing with the distance from them.

    Parameters
    ----------
    edge_length
        Largest edge length [L].
    sources
        ``(k, 2)`` positions of small features [L].
    sizes
        ``(k,)`` edge lengths at the sources [L].
    grade
        Growth of edge lengths per distance from a source.
    """

    def __init__(self, edge_length: float, sources: FloatArray, sizes: FloatArray, grade: float):
        self.edge_length, self._grade = edge_length, grade
        # Sizes first, so that the rows are in their order.
        self._small = np.unique(np.column_stack([sizes, sources])[sizes < 0.95 * edge_length], axis=0)
        # Sources dominated by smaller ones are redundant.
        self._small = self._small[self._small[:, 0] <= self(self._small[:, 1:])]

    @property
    def graded(self) -> bool:
        """Whether edges are shorter than `edge_length` anywhere."""
        return len(self._small) > 0

    @property
    def smallest(self) -> float:
        """Smallest edge length [L]."""
        return float(self._small[:, 0].min(initial=self.edge_length))

    def __call__(self, points: FloatArray) -> FloatArray:
        """Return the edge lengths (n,) at points (n, 2) [L]."""
        return _smallest(np.ascontiguousarray(points), self._small, self._grade, self.edge_length)


@kernel()
def _smallest(points: FloatArray, sources: FloatArray, grade: float, most: float) -> FloatArray:
    """Return the smallest edge lengths (n,) at points (n, 2), of sources (k, 3) of size and place in ascending order of size."""
    found, reach = np.empty(len(points)), (1.0 + 1e-12) / grade**2
    for i in range(len(points)):
        x, y, best = points[i, 0], points[i, 1], most
        for k in range(len(sources)):
            less = best - sources[k, 0]
            if less <= 0.0:
                break
            dx, dy = x - sources[k, 1], y - sources[k, 2]
            square = dx * dx + dy * dy
            if square < reach * less * less:  # Roots are taken of the few that matter.
                best = min(best, sources[k, 0] + grade * np.sqrt(square))
        found[i] = best
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
        ``(k, 2)`` points along parts of the curves that turn by at most 90 degrees, between which gaps are measured [L].
    domain
        Area to be filled.
    nodes
        ``(k, 2)`` points on the curves that become vertices [L].
    points
        ``(k, 2)`` points off the curves that become vertices [L].
    edge_length
        Largest edge length [L].
    grade
        Growth of edge lengths per distance from a small feature.
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
        sizes.append(EDGE_OVER_HEIGHT * shapely.distance(curves, shapely.points(points)))
    narrows, gaps = _narrows(sides, domain, nodes, edge_length)
    smallest = np.maximum(np.concatenate(sizes), MIN_SIZE * edge_length)
    return SizeField(
        edge_length,
        np.concatenate([*sources, narrows]),
        np.concatenate([smallest, np.maximum(EDGE_OVER_HEIGHT * gaps, MIN_GAP_SIZE * edge_length)]),
        grade,
    )


def _narrows(sides: Sequence[FloatArray], domain: shapely.Polygon, nodes: FloatArray, edge_length: float) -> tuple[FloatArray, FloatArray]:
    """Return points (k, 2) where a side passes another one without meeting it, and the gaps (k,) [L]."""
    curves = [shapely.LineString(side) for side in sides]
    places, gaps = [np.empty((0, 2))], [np.empty(0)]
    corners: Any = shapely.points(nodes.reshape(-1, 2))
    for k, j in shapely.STRtree(curves).query(curves, predicate="dwithin", distance=edge_length).T.tolist():
        if k != j:
            shared = corners[np.maximum(*(shapely.distance(curves[i], corners) for i in (k, j))) <= NODE_DISTANCE * edge_length]
            met = shapely.union_all([curves[k].intersection(curves[j]), *shared])
            place, gap = _gap(curves[k], curves[j], met, domain, edge_length)
            places.append(place)
            gaps.append(gap)
    return np.concatenate(places), np.concatenate(gaps)


def _gap(
    curve: shapely.LineString, other: shapely.LineString, met: shapely.Geometry, domain: shapely.Polygon, edge_length: float
) -> tuple[FloatArray, FloatArray]:
    """Return sample points of a curve around its narrowest gaps to another one, and the gaps [L]."""
    step = curve.length / max(2, int(np.ceil(8 * curve.length / edge_length)))
    even = np.arange(round(curve.length / step) + 1) * step
    gap = shapely.distance(shapely.line_interpolate_point(curve, even), other)
    beyond = np.concatenate([[np.inf], gap, [np.inf]]) * (1.0 + 1e-9)
    nearest = np.flatnonzero((gap <= beyond[:-2]) & (gap <= beyond[2:]) & (gap < edge_length))
    beside = gap[nearest, None] * GAP_SAMPLES
    far = GAP_REACH * np.sqrt(gap[nearest] * edge_length)
    around = (np.abs(even[:, None] - even[nearest]) <= far).any(axis=1)
    t = np.concatenate([(even[nearest, None] + beside)[np.abs(beside) < step], even[around]])
    spots = shapely.line_interpolate_point(curve, np.unique(t[(t >= 0.0) & (t <= curve.length)]))
    gap = shapely.distance(spots, other)
    # Gaps towards a crossing are excluded; narrow corners are treated separately.
    apart = ~(shapely.distance(spots, met) <= CROSSING_DISTANCE * edge_length) & (gap > 0.0) & (gap < edge_length)
    spots, gap = spots[apart], gap[apart]
    across = shapely.line_interpolate_point(shapely.shortest_line(spots, other), 0.5, normalized=True)
    inside = shapely.contains(domain, across)
    return shapely.get_coordinates(spots[inside]), gap[inside]


def _bends(line: FloatArray, edge_length: float) -> tuple[FloatArray, FloatArray]:
    """Return points along a curve and the edge lengths required by its curvature."""
    at = arc_lengths(flattened(line))
    ahead = np.diff(line, axis=0)
    turn = np.abs(np.angle(np.exp(1j * np.diff(np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))))))
    # Kinks do not count as curvature.
    turned = np.concatenate([[0.0], np.cumsum(np.where(turn < KINK_ANGLE, turn, 0.0)), [0.0]])
    turned[-1] = turned[-2]
    number = max(2, int(np.ceil(4 * at[-1] / edge_length)))
    t = np.linspace(0.0, at[-1], number + 1)
    half = 0.5 * edge_length
    window = np.minimum(t + half, at[-1]) - np.maximum(t - half, 0.0)
    rate = (np.interp(t + half, at, turned) - np.interp(t - half, at, turned)) / np.maximum(window, 1e-300)
    size = MAX_TURN / np.maximum(rate, 1e-12)
    if (line[0] == line[-1]).all() and (turn < KINK_ANGLE).all():
        size = np.minimum(size, at[-1] / MIN_EDGES)
    return np.column_stack([np.interp(t, at, line[:, k]) for k in range(2)]), size
