"""Size field: how long edges should be where, graded from small features to the length aimed at."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.plan import flattened
from .polyline import arc_lengths

__all__ = ["SizeField", "size_field"]

GRADE = 0.25  # of the distance from a small feature, by which edges grow
TURN = 0.5  # most that a curve turns along an edge [rad]
AROUND = 12  # edges of a closed curve without kinks at least
KINK = np.radians(30.0)
BASE = 1.4  # times the distance of a point from a curve, that edges are long there: a triangle with that height has even angles
SMALLEST = 0.12  # of the edge length
MEETING = 0.25  # of the edge length from a crossing, within which curves are near because they meet


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
    """

    def __init__(self, edge_length: float, sources: FloatArray, sizes: FloatArray):
        self.edge_length = edge_length
        small = sizes < 0.95 * edge_length
        self._sizes = np.maximum(sizes[small], SMALLEST * edge_length)
        self._sources = sources[small]

    def __call__(self, points: FloatArray) -> FloatArray:
        """Return the edge lengths (n,) at points (n, 2)."""
        found = np.full(len(points), self.edge_length)
        for k in range(0, len(self._sources), 64):
            gap = np.linalg.norm(points[:, None] - self._sources[None, k : k + 64], axis=2)
            found = np.minimum(found, (self._sizes[k : k + 64] + GRADE * gap).min(axis=1))
        return found


def size_field(lines: Sequence[FloatArray], nodes: FloatArray, points: FloatArray, edge_length: float) -> SizeField:
    """Return the size field of curves and points.

    Parameters
    ----------
    lines
        ``(k, 2)`` points along each curve [L].
    nodes
        ``(k, 2)`` places on the curves that become vertices [L].
    points
        ``(k, 2)`` places between the curves that do [L].
    edge_length
        The longest [L].
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
    place, size = _narrows(lines, edge_length)
    sources.append(place)
    sizes.append(size)
    if len(points):
        curves = shapely.MultiLineString([shapely.LineString(line) for line in lines])
        sources.append(points)
        sizes.append(BASE * shapely.distance(curves, shapely.points(points)))
    return SizeField(edge_length, np.concatenate(sources), np.concatenate(sizes))


def _narrows(lines: Sequence[FloatArray], edge_length: float) -> tuple[FloatArray, FloatArray]:
    """Return places where one curve passes close by another without meeting it, and edge lengths that fill the gap evenly."""
    curves = [shapely.LineString(line) for line in lines]
    places, sizes = [np.empty((0, 2))], [np.empty(0)]
    for k, curve in enumerate(curves):
        number = max(3, int(np.ceil(8 * curve.length / edge_length)))
        samples = shapely.line_interpolate_point(curve, np.linspace(0.0, curve.length, number))
        for other in (*curves[:k], *curves[k + 1 :]):
            gap = shapely.distance(samples, other)
            # Towards a crossing it falls to nothing; the narrow corner there is a matter of its own.
            met = shapely.distance(samples, curve.intersection(other)) <= MEETING * edge_length
            least = (gap[1:-1] <= gap[:-2]) & (gap[1:-1] <= gap[2:]) & (gap[1:-1] < edge_length) & ~met[1:-1] & (gap[1:-1] > 0.0)
            places.append(shapely.get_coordinates(samples[1:-1][least]))
            sizes.append(BASE * gap[1:-1][least])
    return np.concatenate(places), np.concatenate(sizes)


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
