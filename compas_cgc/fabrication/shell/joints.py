"""Joints of regions: the points along all edges, and the gaps and kinks between the surfaces that meet there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Mask
from .edges import RegionEdge
from .heights import DEGREE
from .heights import HeightSpace
from .heights import located
from .heights import nonzero_functions
from .heights import tensor_products

__all__ = ["Joined", "Joints", "Region"]

PROJECTIONS = 2  # steps by which a point of an edge is moved onto its first surface


class Region(NamedTuple):
    """The splines of a region, and the place of their coefficients among those of all regions."""

    axes: FloatArray  # (3, 3) rows: two axes of the plane and the direction of the heights
    space: HeightSpace
    start: int  # of its coefficients

    def own(self, x: FloatArray) -> FloatArray:
        """Return the coefficients of the region among all coefficients (size,)."""
        return x[self.start : self.start + self.space.size]

    def placed(self, rows: sparse.csr_matrix, size: int) -> sparse.csr_matrix:
        """Return rows on the coefficients of the region as rows on all coefficients."""
        return sparse.csr_matrix((rows.data, rows.indices + self.start, rows.indptr), shape=(rows.shape[0], size))


class Joined(NamedTuple):
    """Gaps and kinks at the points of shared edges, with their derivatives, and the points of all edges."""

    gaps: FloatArray  # (k,) distances of the second surface from the points, signed
    gap_rates: sparse.csr_matrix  # (k, size)
    kinks: FloatArray  # (k,) sines of the angles between the normals about the edge, signed
    sines: FloatArray  # (k,) sines of the angles between the normals, also where the surfaces do not quite meet
    kink_rates: sparse.csr_matrix  # (k, size), without the small effect of points that move on the second surface
    edges: IntArray  # (k,) edge of every point
    curves: list[FloatArray]  # (n, 3) points of every edge on its first surface


class _Side(NamedTuple):
    normals: FloatArray  # (k, 3)
    upright: FloatArray  # (k,) cosines of the slopes
    slopes: tuple[sparse.csr_matrix, sparse.csr_matrix]  # on all coefficients
    axes: FloatArray  # (k, 3, 3)


class _Owned:
    """Points (k,) of regions, and the basis functions of all of them at once, as there may be many regions with few points each."""

    def __init__(self, regions: list[Region], owner: IntArray, size: int):
        self.size = size
        self.axes = np.array([own.axes for own in regions])[owner]
        self.starts, self.widths = (np.array(each)[owner] for each in zip(*((own.start, own.space.shape[1]) for own in regions)))
        self.each = [[own.space.knots[axis] for own in regions] for axis in (0, 1)]
        self.points = [np.flatnonzero(owner == number) for number in range(len(regions))]

    def local(self, points: FloatArray) -> FloatArray:
        """Return points (k, 3) in the axes of their regions."""
        return np.einsum("kij,kj->ki", self.axes, points)

    def basis(self, plan: FloatArray) -> list[sparse.csr_matrix]:
        """Return the basis functions at points (k, 2) of the planes of their regions, and both first derivatives, on all coefficients."""
        first, functions = self.starts, []
        for axis, columns in enumerate((self.widths, np.ones_like(self.widths))):
            inside, spans, start = np.empty(len(plan)), np.empty(len(plan), np.int64), 0
            places = np.empty(len(plan), np.int64)
            for points, knots in zip(self.points, self.each[axis]):
                inside[points], places[points] = located(knots, plan[points, axis])
                spans[points] = start + places[points]
                start += len(knots)
            first = first + columns * (places - DEGREE)
            functions.append([nonzero_functions(np.concatenate(self.each[axis]), inside, spans, order) for order in (0, 1)])
        return [tensor_products(functions[0][u], functions[1][v], first, self.widths, self.size) for u, v in ((0, 0), (1, 0), (0, 1))]


class Joints:
    """Points along the edges of regions; those of shared edges are compared on both surfaces.

    A point is where its first surface meets a line along a given direction. All edges that end at a vertex have the same direction there,
    so that they end at the same point.

    Parameters
    ----------
    regions
        The regions.
    edges
        Their edges.
    lines
        ``(n, 3)`` points of every edge.
    directions
        ``(n, 3)`` unit vectors at these points, for every edge.
    size
        Number of coefficients of all regions.
    """

    def __init__(self, regions: list[Region], edges: list[RegionEdge], lines: list[FloatArray], directions: list[FloatArray], size: int):
        self.ends = np.cumsum([0, *map(len, lines)])
        number = np.repeat(np.arange(len(edges)), np.diff(self.ends))
        first = np.array([edge.regions[0] for edge in edges])[number]
        second = np.array([edge.regions[1] if len(edge.regions) == 2 else -1 for edge in edges])[number]
        self.points, self.directions = np.concatenate(lines), np.concatenate(directions)
        tangents = np.concatenate([np.gradient(line, axis=0) for line in lines])
        self.on_first = _Owned(regions, first, size)
        self.shared = np.flatnonzero(second >= 0)
        self.on_second, self.edges = _Owned(regions, second[self.shared], size), number[self.shared]
        along = tangents[self.shared]
        self.tangents = along / np.linalg.norm(along, axis=1, keepdims=True)

    def at(self, x: FloatArray) -> Joined:
        """Return the gaps and kinks for coefficients (size,)."""
        points, lift, first = self._on_first(x)
        curves = [points[first:last] for first, last in zip(self.ends, self.ends[1:])]
        local = self.on_second.local(points[self.shared])
        other, *slopes = self.on_second.basis(local[:, :2])
        one = _side(x, (first[0][self.shared], first[1][self.shared]), self.on_first.axes[self.shared])
        two = _side(x, (slopes[0], slopes[1]), self.on_second.axes)
        gaps = (local[:, 2] - other @ x) * two.upright
        along = self.directions[self.shared]
        turn = np.einsum("ki,ki->k", along, two.normals) * one.upright / np.einsum("ki,ki->k", along, one.normals)
        gap_rates = lift[self.shared].multiply(turn[:, None]) - other.multiply(two.upright[:, None])
        across = np.cross(one.normals, two.normals)
        kinks, sines = np.einsum("ki,ki->k", self.tangents, across), np.linalg.norm(across, axis=1)
        kink_rates = _turned(one, np.asarray(np.cross(two.normals, self.tangents), dtype=np.float64)) + _turned(
            two, np.asarray(np.cross(self.tangents, one.normals), dtype=np.float64)
        )
        return Joined(gaps, gap_rates.tocsr(), kinks, sines, kink_rates.tocsr(), self.edges, curves)

    def _on_first(self, x: FloatArray) -> tuple[FloatArray, sparse.csr_matrix, list[sparse.csr_matrix]]:
        """Return the points of all edges on their first surfaces (k, 3), and the basis functions and their first derivatives there."""
        points, along = self.points, self.on_first.local(self.directions)
        for _ in range(PROJECTIONS):
            local = self.on_first.local(points)
            lift, *slopes = self.on_first.basis(local[:, :2])
            rise = along[:, 2] - (slopes[0] @ x) * along[:, 0] - (slopes[1] @ x) * along[:, 1]
            points = points + ((lift @ x - local[:, 2]) / rise)[:, None] * self.directions
        lift, *slopes = self.on_first.basis(self.on_first.local(points)[:, :2])
        return points, lift, slopes

    def smooth(self, kinks: FloatArray, most: float) -> Mask:
        """Return the points of shared edges whose median kink is at most an angle [rad] (k,)."""
        found = np.zeros(len(kinks), bool)
        for number in np.unique(self.edges):
            own = self.edges == number
            found[own] = np.median(np.abs(kinks[own])) <= np.sin(most)
        return found


def _side(x: FloatArray, slopes: tuple[sparse.csr_matrix, ...], axes: FloatArray) -> _Side:
    p, q = slopes[0] @ x, slopes[1] @ x
    upright = 1.0 / np.sqrt(1.0 + p * p + q * q)
    local = np.column_stack([-p, -q, np.ones(len(p))]) * upright[:, None]
    return _Side(np.einsum("ki,kij->kj", local, axes), upright, (slopes[0], slopes[1]), axes)


def _turned(side: _Side, way: FloatArray) -> sparse.csr_matrix:
    """Return the derivatives of the components of the normals of one side along directions (k, 3)."""
    way = way - np.einsum("ki,ki->k", way, side.normals)[:, None] * side.normals
    p, q = (-np.einsum("ki,ki->k", way, side.axes[:, axis]) * side.upright for axis in (0, 1))
    return side.slopes[0].multiply(p[:, None]) + side.slopes[1].multiply(q[:, None])
