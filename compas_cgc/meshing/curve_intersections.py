"""Intersections of a curve with the edges of a mesh."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from ..discrete import face_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from .polyline import arc_lengths
from .polyline import resample_all

__all__ = ["Crossings", "curve_crossings"]


class Crossings(NamedTuple):
    """Crossings of a curve with edges, in their order along the curve."""

    edge: IntArray  # (k,) index of the edge
    t: FloatArray  # (k,) position on the edge, 0 at its first and 1 at its second end
    vertex: IntArray  # (k,) vertex near the crossing, or -1
    point: FloatArray  # (k, 3) on the edge [L]


def curve_crossings(vertices: FloatArray, faces: IntArray, edges: IntArray, curve: FloatArray, snap: float) -> Crossings:
    """Return the crossings of a curve on or near a mesh with its edges.

    A crossing is a point where the curve pierces the plane through an edge and its normal.

    Parameters
    ----------
    vertices, faces
        ``(n, 3)`` [L] and ``(m, 3)``.
    edges
        ``(e, 4)`` edges as in :func:`compas_cgc.discrete.edge_faces`.
    curve
        ``(k, 3)`` points along the curve [L].
    snap
        A crossing nearer to a vertex than this fraction of the edge is moved to the vertex.
    """
    u, v = edges[:, 0], edges[:, 1]
    along = vertices[v] - vertices[u]
    length = np.linalg.norm(along, axis=1)
    normal = face_normals(vertices, faces)
    n = normal[edges[:, 2]] + np.where(edges[:, 3:] >= 0, normal[edges[:, 3]], 0.0)
    n /= np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)
    across = np.cross(n, along)
    line = resample_all(curve, 0.5 * float(np.median(length)))
    at = arc_lengths(line)
    start, way = line[:-1], np.diff(line, axis=0)
    tree = cKDTree(0.5 * (vertices[u] + vertices[v]))
    reach = 0.5 * np.linalg.norm(way, axis=1) + 0.6 * float(length.max())
    near = tree.query_ball_point(start + 0.5 * way, reach, return_sorted=True)
    piece = np.repeat(np.arange(len(start)), [len(found) for found in near])
    e = np.array([i for found in near for i in found], dtype=np.int64)
    before = np.einsum("ij,ij->i", start[piece] - vertices[u[e]], across[e])
    after = np.einsum("ij,ij->i", line[piece + 1] - vertices[u[e]], across[e])
    pierced = (before < 0) != (after < 0)
    piece, e, before, after = piece[pierced], e[pierced], before[pierced], after[pierced]
    share = before / (before - after)
    place = start[piece] + share[:, None] * way[piece]
    off = place - vertices[u[e]]
    t = np.einsum("ij,ij->i", off, along[e]) / length[e] ** 2
    height = np.abs(np.einsum("ij,ij->i", off, n[e]))
    # On a curved surface a curve may pass between the planes of edges at a vertex, so these are extended slightly.
    met = (t >= -0.05) & (t <= 1.05) & (height <= 0.5 * length[e])
    e, t = e[met], np.clip(t[met], 0.0, 1.0)
    position = at[piece[met]] + share[met] * np.linalg.norm(way[piece[met]], axis=1)
    order = np.lexsort((e, position))
    e, t = e[order], t[order]
    vertex = _snapped(u[e], v[e], t, snap)
    t = np.where(vertex < 0, t, np.where(vertex == u[e], 0.0, 1.0))
    fresh = np.ones(len(e), bool)
    fresh[1:] = (vertex[1:] < 0) | (vertex[1:] != vertex[:-1])
    e, t, vertex = e[fresh], t[fresh], vertex[fresh]
    kept = _without_spikes(vertex)
    e, t, vertex = e[kept], t[kept], vertex[kept]
    return Crossings(e, t, vertex, vertices[u[e]] + t[:, None] * along[e])


def _snapped(u: IntArray, v: IntArray, t: FloatArray, snap: float) -> IntArray:
    """Return the vertex of every crossing or -1; crossings adjacent to one at their nearer vertex join it."""
    near = np.where(t < 0.5, u, v)
    vertex = np.where(np.minimum(t, 1.0 - t) < snap, near, -1)
    for step in (range(1, len(t)), range(len(t) - 2, -1, -1)):
        back = 1 if step.step > 0 else -1
        for i in step:
            if vertex[i] < 0 and vertex[i - back] == near[i]:
                vertex[i] = near[i]
    return vertex


def _without_spikes(vertex: IntArray) -> list[int]:
    """Return the crossings without those between two at the same vertex."""
    kept: list[int] = []
    for i in range(len(vertex)):
        if len(kept) > 1 and vertex[i] >= 0 and vertex[kept[-2]] == vertex[i]:
            kept.pop()
        else:
            kept.append(i)
    return kept
