"""Curve tracing: vertex paths along the edges that follow a curve."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask
from .map_matching import EdgeNet
from .map_matching import match_path
from .polyline import arc_lengths
from .polyline import nearest_on_polyline
from .polyline import points_along
from .polyline import resample

__all__ = ["Trace", "follow_edges", "path_deviation", "trace_curve"]


class Trace(NamedTuple):
    """The edges of a mesh along a curve."""

    paths: list[list[int]]  # vertex paths, one per stretch of the curve on the mesh
    deviation: float  # largest distance between the curve and the paths [L]
    outside: float  # length of the curve that lies off the mesh and was left out [L]
    exact: bool  # the curve runs from vertex to vertex along the edges


def follow_edges(net: EdgeNet, curve: FloatArray, tolerance: float) -> Optional[list[int]]:
    """Return the path of vertices that a curve runs through along edges, or None if it leaves them.

    Parameters
    ----------
    net
        Edges of the mesh.
    curve
        ``(k, 3)`` points along the curve [L].
    tolerance
        Largest distance of the vertices from the curve, and of its ends from the first and last of them [L].
    """

    def joined(path: list[int]) -> bool:
        return len(path) > 1 and all(v in net.neighbours(u) for u, v in zip(path[:-1], path[1:]))

    # A polyline from vertex to vertex says itself which ones, however near others may be.
    distance, nearest = net.tree.query(curve)
    if (distance <= tolerance).all():
        corners = nearest[np.append(True, nearest[1:] != nearest[:-1])].tolist()
        if joined(corners):
            return corners
    path = points_along(net.vertices, curve, tolerance).tolist()
    if len(path) > 1 and np.linalg.norm(curve[0] - curve[-1]) <= tolerance and path[0] != path[-1]:
        path.append(path[0])
    if not joined(path):
        return None
    ends = np.linalg.norm(net.vertices[[path[0], path[-1]]] - curve[[0, -1]], axis=1)
    return path if path[0] == path[-1] or (ends <= 2.0 * tolerance).all() else None


def path_deviation(vertices: FloatArray, path: list[int], curve: FloatArray, both: bool = True) -> float:
    """Return the largest distance between a path and the curve it stands for [L].

    With `both` either way, otherwise only from the path to the curve, which may go on.
    """
    line = vertices[path]
    spacing = max(np.linalg.norm(np.diff(line, axis=0), axis=1).min(), 1e-3 * np.linalg.norm(np.ptp(line, axis=0))) / 4
    deviation = nearest_on_polyline(resample(line, spacing), curve)[0].max()
    if both:
        deviation = max(deviation, nearest_on_polyline(resample(curve, spacing), line)[0].max())
    return float(deviation)


def trace_curve(net: EdgeNet, curve: FloatArray, tolerance: float, anchors: Optional[Mask] = None) -> Trace:
    """Find the edges of a mesh that follow a curve best.

    A curve along edges gives exactly these. Any other is matched as a road map is to a
    track: its samples each take a nearby vertex, so that successive ones are equal or
    joined by an edge and the sum of squared distances with a little of the length is
    least (the Viterbi algorithm). What of the curve lies off the mesh is left out.

    Parameters
    ----------
    net
        Edges of the mesh.
    curve
        ``(k, 3)`` points along the curve [L], first and last equal if it is closed.
    tolerance
        Largest distance of vertices that lie on the curve [L].
    anchors
        ``(n,)`` bool: vertices to end at where the curve ends near one (on the boundary,
        on other creases).

    Returns
    -------
    Trace
        Without paths when the curve comes nowhere near an edge.
    """
    exact = follow_edges(net, curve, tolerance)
    if exact is not None:
        return Trace([exact], path_deviation(net.vertices, exact, curve), 0.0, True)
    reach = net.longest()
    samples = resample(curve, _spacing(net, curve))
    closed = bool(np.linalg.norm(curve[0] - curve[-1]) <= tolerance)
    distance, nearest = net.tree.query(samples)
    if closed:
        # Begin where the curve comes nearest to a vertex: it is sure to pass there.
        turn = int(np.argmin(distance[:-1]))
        order = np.concatenate([np.arange(turn, len(samples) - 1), np.arange(turn + 1)])
        samples, distance, nearest = samples[order], distance[order], nearest[order]
    on = distance <= 0.75 * reach[nearest]
    paths, deviation = [], 0.0
    for first, last in _runs(on):
        run = samples[first : last + 1]
        loop = closed and len(run) == len(samples)
        path = match_path(net, run, reach[nearest[first : last + 1]], anchors, loop)
        if len(path) > 1:
            paths.append(path)
            deviation = max(deviation, path_deviation(net.vertices, path, run))
    outside = float(np.linalg.norm(samples[1] - samples[0])) * int(np.count_nonzero(~on))
    return Trace(paths, deviation, outside, False)


def _spacing(net: EdgeNet, curve: FloatArray) -> float:
    """Return half the shortest edge near a curve, so that a path takes at most one edge from sample to sample [L]."""
    length = float(arc_lengths(curve)[-1])
    lengths = net.lengths
    _, nearest = net.tree.query(resample(curve, max(float(np.median(lengths.data)), 1e-4 * length)))
    around = np.concatenate([lengths.data[lengths.indptr[v] : lengths.indptr[v + 1]] for v in np.unique(nearest)])
    return max(0.5 * float(around.min(initial=np.inf)), 5e-5 * length) if len(around) else length


def _runs(on: Mask) -> list[tuple[int, int]]:
    """Return the first and last index of every stretch of True."""
    change = np.flatnonzero(np.diff(np.concatenate([[False], on, [False]]).astype(np.int8)))
    return [(int(a), int(b) - 1) for a, b in zip(change[::2], change[1::2])]
