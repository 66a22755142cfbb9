"""Viterbi map matching: the edge path of a mesh that follows a curve best."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from ..discrete.arrays import CSRIndices
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask

__all__ = ["EdgeNet", "edge_net", "match_path"]


class EdgeNet(NamedTuple):
    """Edge graph of a mesh."""

    vertices: FloatArray  # (n, 3) [L]
    lengths: sparse.csr_matrix  # (n, n) symmetric, edge lengths [L]
    tree: cKDTree  # of the vertices

    def neighbours(self, v: int) -> CSRIndices:
        """Return the neighbours of a vertex."""
        return self.lengths.indices[self.lengths.indptr[v] : self.lengths.indptr[v + 1]]

    def longest(self) -> FloatArray:
        """Return the length of the longest edge at every vertex, 0 without edges (n,) [L]."""
        most = np.maximum.reduceat(np.append(self.lengths.data, 0.0), self.lengths.indptr[:-1])
        return most * (np.diff(self.lengths.indptr) > 0)


def edge_net(vertices: FloatArray, faces: IntArray) -> EdgeNet:
    """Return the edge graph of a mesh with vertices (n, 3) [L], all used, and faces (m, 3)."""
    n = len(vertices)
    u, v = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    u, v = np.concatenate([u, v]), np.concatenate([v, u])
    lengths = sparse.csr_matrix((np.ones(len(u)), (u, v)), shape=(n, n))
    lengths.sum_duplicates()
    first = np.repeat(np.arange(n), np.diff(lengths.indptr))
    lengths.data = np.linalg.norm(vertices[first] - vertices[lengths.indices], axis=1)
    return EdgeNet(vertices, lengths, cKDTree(vertices))


def match_path(net: EdgeNet, samples: FloatArray, reach: FloatArray, anchors: Optional[Mask], loop: bool) -> list[int]:
    """Return the edge path that follows samples of a curve best (Viterbi algorithm).

    Every sample is assigned a vertex, equal to the previous one or its neighbour. The cost
    is the sum of squared distances plus a small multiple of the length.

    Parameters
    ----------
    net
        Edges of the mesh.
    samples
        ``(k, 3)`` points along the curve [L], closer than half the shortest edge.
    reach
        ``(k,)`` largest distance of a vertex from its sample [L].
    anchors
        ``(n,)`` bool: preferred end vertices.
    loop
        Whether the curve is closed; the path then ends where it begins.

    Returns
    -------
    list of int
        Vertices without repetitions; empty if there is no path.
    """
    vertices, lengths = net.vertices, net.lengths
    step = float(np.linalg.norm(samples[-1] - samples[-2])) if len(samples) > 1 else 0.0
    tangent = np.gradient(samples, axis=0) if len(samples) > 1 else np.zeros_like(samples)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-300)
    candidates = net.tree.query_ball_point(samples, reach, return_sorted=True)
    candidates[0] = [_end_vertex(vertices, candidates[0], samples[0], None if loop else anchors)]
    candidates[-1] = candidates[0] if loop else [_end_vertex(vertices, candidates[-1], samples[-1], anchors)]
    cost = {candidates[0][0]: 0.0}
    before: list[dict[int, int]] = []
    for i in range(1, len(samples)):
        off = vertices[candidates[i]] - samples[i]
        ahead = off @ tangent[i]
        # Offsets along the curve cost little; offsets to the side cost fully.
        squares = np.einsum("ij,ij->i", off, off) - 0.9 * ahead**2
        fee = dict(zip(candidates[i], (step * squares / reach[i] ** 2).tolist()))
        new: dict[int, float] = {}
        link: dict[int, int] = {}
        for v in candidates[i]:
            row = slice(lengths.indptr[v], lengths.indptr[v + 1])
            ways = [(cost[u] + 0.1 * w, u) for u, w in zip(lengths.indices[row].tolist(), lengths.data[row].tolist()) if u in cost]
            if v in cost:
                ways.append((cost[v], v))
            if ways:
                value, link[v] = min(ways)
                new[v] = value + fee[v]
        if not new:
            return []
        cost = new
        before.append(link)
    v = candidates[-1][0]
    if v not in cost:
        return []
    path = [v]
    for link in reversed(before):
        v = link[v]
        if v != path[-1]:
            path.append(v)
    return _without_spikes(path[::-1])


def _end_vertex(vertices: FloatArray, candidates: list[int], end: FloatArray, anchors: Optional[Mask]) -> int:
    """Return the nearest vertex to an end, preferably an anchor."""
    preferred = [v for v in candidates if anchors is not None and anchors[v]] or candidates
    distance = np.linalg.norm(vertices[preferred] - end, axis=1)
    return preferred[int(np.argmin(distance))]


def _without_spikes(path: list[int]) -> list[int]:
    """Return a path without steps to a vertex and straight back."""
    clean: list[int] = []
    for v in path:
        if len(clean) > 1 and clean[-2] == v:
            clean.pop()
        else:
            clean.append(v)
    return clean
