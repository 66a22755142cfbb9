"""The filter of Eqs. 23-26: a weighted mean of the gradients within a radius."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from scipy import sparse
from scipy.spatial import cKDTree

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray

__all__ = ["GradientFilter"]

SKIN = 0.2  # extra reach of the neighbour lists, as a part of the radius
MOST_PAIRS = 60_000_000  # about one gigabyte of neighbour lists


@njit(cache=True)
def weighted_means(P, G, rows, start, neighbours, radius, power):
    """Return the mean of `G` around every vertex of `rows`, weighted by Eq. 24 (n, 3)."""
    out = np.zeros_like(P)
    cube = power == 3.0
    for r in range(rows.shape[0]):
        i = rows[r]
        total, x, y, z = 0.0, 0.0, 0.0, 0.0
        for a in range(start[r], start[r + 1]):
            j = neighbours[a]
            dx, dy, dz = P[i, 0] - P[j, 0], P[i, 1] - P[j, 1], P[i, 2] - P[j, 2]
            near = 1.0 - math.sqrt(dx * dx + dy * dy + dz * dz) / radius
            if near > 0.0:
                w = near * near * near if cube else near**power
                total += w
                x += w * G[j, 0]
                y += w * G[j, 1]
                z += w * G[j, 2]
        if total > 0.0:
            out[i, 0], out[i, 1], out[i, 2] = x / total, y / total, z / total
    return out


@njit(cache=True)
def farthest(P, Q):
    """Return the largest distance between the rows of two arrays."""
    most = 0.0
    for i in range(P.shape[0]):
        d = (P[i, 0] - Q[i, 0]) ** 2 + (P[i, 1] - Q[i, 1]) ** 2 + (P[i, 2] - Q[i, 2]) ** 2
        if d > most:
            most = d
    return math.sqrt(most)


class GradientFilter:
    """Filter with neighbour lists that are kept until a vertex has moved too far.

    The lists reach a little beyond the radius; while no vertex has moved by more than
    half of that margin they hold every pair that counts, and the weights are computed
    from the present distances.

    Parameters
    ----------
    sources
        Vertices whose gradients count: the internal ones (Eq. 24).
    rows
        Vertices that a filtered gradient is wanted for: all that move.
    faces
        ``(m, 3)``: without a radius, vertices that are no source take the mean of their
        neighbours in the mesh.
    radius
        d̄ [L]; zero for no filter.
    power
        p of Eq. 24.
    refilter
        Measure distances on the present shape, or on the first one seen.
    """

    def __init__(self, sources: IntArray, rows: IntArray, faces: IntArray, *, radius: float, power: float, refilter: bool):
        self.sources = sources
        self.rows = rows
        self.faces = faces
        self.radius = float(radius)
        self.power = float(power)
        self.refilter = refilter
        self._built_at: FloatArray | None = None
        self._means: sparse.csr_matrix | None = None

    def __call__(self, vertices: FloatArray, gradient: FloatArray) -> FloatArray:
        """Return the filtered gradient (n, 3): zero at vertices outside `rows`."""
        if self.radius == 0.0:
            return self._unfiltered(gradient)
        if self._built_at is None or (self.refilter and farthest(vertices, self._built_at) > 0.5 * SKIN * self.radius):
            self._build(vertices)
        shape = vertices if self.refilter else self._built_at
        return weighted_means(shape, gradient, self.rows, self._start, self._neighbours, self.radius, self.power)

    def _build(self, vertices: FloatArray) -> None:
        reach = self.radius * (1.0 + SKIN if self.refilter else 1.0)
        sources, rows = cKDTree(vertices[self.sources]), cKDTree(vertices[self.rows])
        pairs = rows.count_neighbors(sources, reach)
        if pairs > MOST_PAIRS:
            mean = pairs // max(1, len(self.rows))
            raise ValueError(f"filter_radius reaches {mean} vertices around each vertex, too many to hold; choose a smaller radius")
        table = rows.sparse_distance_matrix(sources, reach, output_type="ndarray")
        # Stable orders make the sums, and so the result, the same in every run.
        order = np.lexsort((table["j"], table["i"]))
        self._neighbours = self.sources[table["j"][order]]
        self._start = np.concatenate([[0], np.cumsum(np.bincount(table["i"], minlength=len(self.rows)))])
        self._built_at = vertices.copy()

    def _unfiltered(self, gradient: FloatArray) -> FloatArray:
        if self._means is None:
            self._means = self._neighbour_means(len(gradient))
        return self._means @ gradient

    def _neighbour_means(self, n: int) -> sparse.csr_matrix:
        source = np.zeros(n, bool)
        source[self.sources] = True
        others = self.rows[~source[self.rows]]
        u, v = self.faces.ravel(), np.roll(self.faces, -1, axis=1).ravel()
        adjacency = sparse.csr_matrix((np.ones(2 * len(u)), (np.r_[u, v], np.r_[v, u])), shape=(n, n))
        adjacency.data[:] = 1.0
        picked = sparse.diags(np.isin(np.arange(n), others).astype(float)) @ adjacency @ sparse.diags(source.astype(float))
        count = np.asarray(picked.sum(axis=1)).ravel()
        scale = np.divide(1.0, count, out=np.zeros(n), where=count > 0)
        return (sparse.diags(scale) @ picked + sparse.diags(source.astype(float))).tocsr()
