"""Polylines: arc lengths, distances and resampling."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray

__all__ = ["arc_lengths", "nearest_on_polyline", "point_at", "points_along", "resample", "resample_all"]

MAX_PAIRS = 2_000_000  # of points and segments of which all distances are computed
BLOCK = 1000  # points whose neighbours are searched at once
LENGTH_RATIO = 1e-6  # length below which segments of a polyline need no class of their own, relative to its longest one


def arc_lengths(polyline: FloatArray) -> FloatArray:
    """Return the arc lengths of the points of a polyline (k, d): (k,) [L]."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(polyline, axis=0), axis=1))])


def nearest_on_polyline(points: FloatArray, polyline: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the distance of each point from a polyline, and the arc length of the nearest point on it.

    Parameters
    ----------
    points
        ``(n, 3)`` coordinates [L].
    polyline
        ``(k, 3)`` coordinates [L], k >= 2.

    Returns
    -------
    distance (n,), position (n,) [L]
    """
    if len(points) * len(polyline) > MAX_PAIRS:
        return _nearest_by_trees(points, polyline)
    start, along = polyline[:-1], np.diff(polyline, axis=0)
    length2 = np.einsum("ij,ij->i", along, along)
    off = points[:, None, :] - start
    t = np.clip(np.einsum("nkj,kj->nk", off, along) / np.where(length2 > 0, length2, 1.0), 0.0, 1.0)
    gap = np.linalg.norm(off - t[:, :, None] * along, axis=2)
    best, row = np.argmin(gap, axis=1), np.arange(len(points))
    return gap[row, best], arc_lengths(polyline)[best] + t[row, best] * np.sqrt(length2[best])


def _nearest_by_trees(points: FloatArray, polyline: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the same as :func:`nearest_on_polyline` without forming all pairs of points and segments.

    The nearest corner bounds the distance of a point, and thus that of the middle of its nearest segment. Segments are searched by classes
    of length, as a long one would widen the bound of all.
    """
    start, along, at = polyline[:-1], np.diff(polyline, axis=0), arc_lengths(polyline)
    length = np.linalg.norm(along, axis=1)
    bound = cKDTree(polyline).query(points)[0]
    distance, position = np.full(len(points), np.inf), np.zeros(len(points))
    size = np.frexp(np.maximum(length, LENGTH_RATIO * length.max(initial=0.0)))[1]
    for own in np.unique(size):
        segments = np.flatnonzero(size == own)
        tree = cKDTree(start[segments] + 0.5 * along[segments])
        for low in range(0, len(points), BLOCK):
            reach = (bound[low : low + BLOCK] + 0.5 * np.ldexp(1.0, own)) * (1.0 + 1e-9)
            near = tree.query_ball_point(points[low : low + BLOCK], reach, return_sorted=True)
            count = np.array([len(found) for found in near])
            point = low + np.repeat(np.arange(len(near)), count)
            segment = segments[np.array([j for found in near for j in found], np.int64)]
            off = points[point] - start[segment]
            square = np.where(length[segment] > 0, length[segment], 1.0) ** 2
            t = np.clip(np.einsum("ij,ij->i", off, along[segment]) / square, 0.0, 1.0)
            gap = np.linalg.norm(off - t[:, None] * along[segment], axis=1)
            order = np.lexsort((segment, gap, point))
            best = order[np.unique(point[order], return_index=True)[1]]
            best = best[gap[best] < distance[point[best]]]
            distance[point[best]], position[point[best]] = gap[best], at[segment[best]] + t[best] * length[segment[best]]
    return distance, position


def points_along(points: FloatArray, polyline: FloatArray, tolerance: float) -> IntArray:
    """Return the points on a polyline, in order along it.

    A point that a closed or self-touching polyline passes twice is listed twice.

    Parameters
    ----------
    points
        ``(n, 3)`` coordinates [L].
    polyline
        ``(k, 3)`` coordinates [L], k >= 2.
    tolerance
        Largest distance of a point on the polyline [L].
    """
    tree = cKDTree(points)
    start, along = polyline[:-1], np.diff(polyline, axis=0)
    length = np.linalg.norm(along, axis=1)
    at = arc_lengths(polyline)
    near = tree.query_ball_point(0.5 * (start + polyline[1:]), 0.5 * length + 1.0000001 * tolerance, return_sorted=True)
    segment = np.repeat(np.arange(len(start)), [len(found) for found in near])
    point = np.array([i for found in near for i in found], dtype=np.int64)
    off = points[point] - start[segment]
    t = np.einsum("ij,ij->i", off, along[segment]) / np.where(length > 0, length, 1.0)[segment] ** 2
    t = np.clip(t, 0.0, 1.0)
    gap = np.linalg.norm(off - t[:, None] * along[segment], axis=1)
    position = at[segment] + t * length[segment]
    hit = gap <= tolerance
    point, position, gap = point[hit], position[hit], gap[hit]
    # Consecutive segments may both be near a point; this counts as one meeting.
    order = np.lexsort((position, point))
    point, position, gap = point[order], position[order], gap[order]
    fresh = np.ones(len(point), bool)
    reach = 4.0 * tolerance + 1e-12 * at[-1]
    fresh[1:] = (point[1:] != point[:-1]) | (position[1:] - position[:-1] > reach)
    meeting = np.cumsum(fresh) - 1
    best = np.lexsort((gap, meeting))
    _, first = np.unique(meeting[best], return_index=True)
    chosen = best[first]
    return point[chosen][np.lexsort((point[chosen], position[chosen]))]


def point_at(polyline: FloatArray, position: FloatArray) -> FloatArray:
    """Return the points at arc lengths (n,) [L] along a polyline (k, d): (n, d)."""
    at = arc_lengths(polyline)
    return np.column_stack([np.interp(position, at, coordinate) for coordinate in polyline.T])


def resample(polyline: FloatArray, spacing: float) -> FloatArray:
    """Return evenly spaced points along a polyline, at most `spacing` apart, including both ends."""
    length = float(arc_lengths(polyline)[-1])
    count = max(1, int(np.ceil(length / spacing)))
    return point_at(polyline, np.linspace(0.0, length, count + 1))


def resample_all(polyline: FloatArray, spacing: float) -> FloatArray:
    """Return a polyline with points added so that they are at most `spacing` apart."""
    at = arc_lengths(polyline)
    count = np.maximum(1, np.ceil(np.diff(at) / spacing)).astype(np.int64)
    first = np.repeat(at[:-1], count)
    inside = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    position = np.append(first + inside * np.repeat(np.diff(at) / count, count), at[-1])
    points = point_at(polyline, position)
    # The old points are kept exactly.
    points[np.append(np.cumsum(count) - count, len(position) - 1)] = polyline
    return points
