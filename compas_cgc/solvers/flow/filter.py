"""Gradient filter: a weighted mean of the gradients within a radius (Eq. 23, Eq. 24, Eq. 25, Eq. 26)."""

from __future__ import annotations

import math
from typing import Optional

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from ..._compiled import kernel
from ...discrete.arrays import Faces
from ...discrete.arrays import Indices
from ...discrete.arrays import Vectors
from ...discrete.arrays import Vertices

__all__ = ["GradientFilter"]

SKIN = 0.2  # additional radius of the neighbour lists over the filter radius; lists then hold for some steps, and are 44 % longer
MOST_PAIRS = 60_000_000  # pairs of neighbours; they take about one gigabyte


@kernel()
def weighted_means(P: Vertices, G: Vectors, rows: Indices, start: Indices, neighbours: Indices, radius: float, power: float) -> Vectors:
    """Return the mean of `G` around every vertex of `rows` (n, 3), Eq. 26.

    The distances are cut off at the radius (Eq. 23); the weights of Eq. 24 are
    normalized by their sum (Eq. 25).
    """
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


@kernel()
def farthest(P: Vertices, Q: Vertices) -> float:
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
        Vertices whose gradients count: the internal ones (the cases of Eq. 24).
    rows
        Vertices that a filtered gradient is wanted for: all that move.
    faces
        ``(m, 3)``: without a radius, vertices that are not among the sources take the
        mean of their neighbours in the mesh.
    radius
        d̄ of Eq. 23 [L]; zero for no filter.
    power
        p of Eq. 24.
    refilter
        Measure distances on the present shape, or on the first one seen.
    """

    def __init__(self, sources: Indices, rows: Indices, faces: Faces, *, radius: float, power: float, refilter: bool):
        self.sources = sources
        self.rows = rows
        self.faces = faces
        self.radius = float(radius)
        self.power = float(power)
        self.refilter = refilter
        self._built_at: Optional[Vertices] = None
        self._means: Optional[sparse.csr_matrix] = None

    def __call__(self, vertices: Vertices, gradient: Vectors) -> Vectors:
        """Return the filtered gradient (n, 3): zero at vertices outside `rows`."""
        if self.radius == 0.0:
            return self._unfiltered(gradient)
        built_at = self._built_at
        if built_at is None or (self.refilter and farthest(vertices, built_at) > 0.5 * SKIN * self.radius):
            built_at = self._build(vertices)
        shape = vertices if self.refilter else built_at
        return weighted_means(shape, gradient, self.rows, self._start, self._neighbours, self.radius, self.power)

    def _build(self, vertices: Vertices) -> Vertices:
        """Build the neighbour lists of a shape, and return a copy of it."""
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
        self._built_at = built_at = vertices.copy()
        return built_at

    def _unfiltered(self, gradient: Vectors) -> Vectors:
        means = self._means
        if means is None:
            means = self._means = self._neighbour_means(len(gradient))
        return means @ gradient

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
