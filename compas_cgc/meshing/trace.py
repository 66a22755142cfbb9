"""Curve tracing: vertex paths along edges that follow a curve."""

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
    outside: float  # length of the curve off the mesh, which is ignored [L]
    exact: bool  # whether the curve runs from vertex to vertex along edges


def follow_edges(net: EdgeNet, curve: FloatArray, tolerance: float) -> Optional[list[int]]:
    """Return the path of vertices if a curve runs along edges, else None.

    Parameters
    ----------
    net
        Edges of the mesh.
    curve
        ``(k, 3)`` points along the curve [L].
    tolerance
        Largest distance of the vertices from the curve, and of its ends from the first and last vertex [L].
    """

    def joined(path: list[int]) -> bool:
        return len(path) > 1 and all(v in net.neighbours(u) for u, v in zip(path[:-1], path[1:]))

    # A polyline from vertex to vertex determines the vertices directly.
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
    """Return the largest distance between a path and its curve [L].

    With `both` in both directions, otherwise only from the path to the curve, which may continue.
    """
    line = vertices[path]
    spacing = max(np.linalg.norm(np.diff(line, axis=0), axis=1).min(), 1e-3 * np.linalg.norm(np.ptp(line, axis=0))) / 4
    deviation = nearest_on_polyline(resample(line, spacing), curve)[0].max()
    if both:
        deviation = max(deviation, nearest_on_polyline(resample(curve, spacing), line)[0].max())
    return float(deviation)


def trace_curve(net: EdgeNet, curve: FloatArray, tolerance: float, anchors: Optional[Mask] = None) -> Trace:
    """Return the edges of a mesh that follow a curve best.

    A curve along edges gives exactly these. Any other curve is map-matched: its samples are
    assigned nearby vertices, with successive ones equal or joined by an edge, that minimise
    the sum of squared distances plus a small multiple of the length (Viterbi algorithm).
    Parts of the curve off the mesh are ignored.

    Parameters
    ----------
    net
        Edges of the mesh.
    curve
        ``(k, 3)`` points along the curve [L], first and last equal if it is closed.
    tolerance
        Largest distance of vertices on the curve [L].
    anchors
        ``(n,)`` bool: preferred end vertices, such as those on the boundary or on other
        creases.

    Returns
    -------
    Trace
        Without paths if the curve is not near any edge.
    """
    exact = follow_edges(net, curve, tolerance)
    if exact is not None:
        return Trace([exact], path_deviation(net.vertices, exact, curve), 0.0, True)
    reach = net.longest()
    samples = resample(curve, _spacing(net, curve))
    closed = bool(np.linalg.norm(curve[0] - curve[-1]) <= tolerance)
    distance, nearest = net.tree.query(samples)
    if closed:
        # Start at the nearest vertex, through which the path certainly passes.
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
    """Return half the shortest edge length near a curve, so that a path has at most one edge per sample [L]."""
    length = float(arc_lengths(curve)[-1])
    lengths = net.lengths
    _, nearest = net.tree.query(resample(curve, max(float(np.median(lengths.data)), 1e-4 * length)))
    around = np.concatenate([lengths.data[lengths.indptr[v] : lengths.indptr[v + 1]] for v in np.unique(nearest)])
    return max(0.5 * float(around.min(initial=np.inf)), 5e-5 * length) if len(around) else length


def _runs(on: Mask) -> list[tuple[int, int]]:
    """Return the first and last index of every stretch of True."""
    change = np.flatnonzero(np.diff(np.concatenate([[False], on, [False]]).astype(np.int8)))
    return [(int(a), int(b) - 1) for a, b in zip(change[::2], change[1::2])]
