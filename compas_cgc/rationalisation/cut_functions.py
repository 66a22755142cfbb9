"""Basis functions of a spline surface that are cut along creases, so that it may fold there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ..discrete import edge_faces
from ..discrete.arrays import Edges
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..meshing.chains import chains

__all__ = ["CreasedMesh", "CutFunctions", "cut_functions", "span_widths"]

DEGREE = 3
CLOSE = 1e-3  # of the shortest sharp edge, within which ends of two are one
INSIDE = 1e-9  # of a support, by which an edge has to reach into it


@dataclass(frozen=True, eq=False)
class CreasedMesh:
    """The mesh of a design in the plane of its parameters, with the edges along which it folds."""

    faces: IntArray  # (m, 3)
    corners: FloatArray  # (m, 3, 2) parameters of the corners of every face, contiguous where parameters close
    creases: Edges  # (c, 4) the ends of every sharp edge, and the faces beside it
    period: FloatArray  # (2,) of parameters that close, infinite for others

    @cached_property
    def beside(self) -> IntArray:
        """Face beyond the edge from each corner to the next one (m, 3), -1 across creases and the rim."""
        sharp = {(min(a, b), max(a, b)) for a, b in self.creases[:, :2].tolist()}
        found = np.full(self.faces.shape, -1)
        for a, b, left, right in edge_faces(self.faces).tolist():
            if right >= 0 and (min(a, b), max(a, b)) not in sharp:
                for own, other in ((left, right), (right, left)):
                    face = self.faces[own].tolist()
                    k = face.index(a)
                    found[own, k if face[(k + 1) % 3] == b else (k + 2) % 3] = other
        return found

    @cached_property
    def shifts(self) -> FloatArray:
        """Multiples of the periods by which a part of the mesh may be shifted (s, 2)."""
        steps = [(-p, 0.0, p) if np.isfinite(p) else (0.0,) for p in self.period.tolist()]
        return np.array([(u, v) for u in steps[0] for v in steps[1]])

    def sides(self) -> tuple[IntArray, IntArray]:
        """Return every vertex once for each of its sides between creases (k,), and a face of this side (k,)."""
        m = len(self.faces)
        number = np.arange(3 * m).reshape(m, 3)
        links = []
        for k in range(3):
            own = np.flatnonzero(self.beside[:, k] >= 0)
            other = self.beside[own, k]
            for end in (k, (k + 1) % 3):
                same = self.faces[other] == self.faces[own, end][:, None]
                links.append(np.column_stack([number[own, end], number[other, np.argmax(same, axis=1)]]))
        pairs = np.concatenate(links)
        graph = sparse.csr_matrix((np.ones(len(pairs)), pairs.T), shape=(3 * m, 3 * m))
        first = np.unique(connected_components(graph, directed=False)[1], return_index=True)[1]
        first = first[np.argsort(self.faces.ravel()[first], kind="stable")]
        return self.faces.ravel()[first], first // 3

    def lines(self) -> tuple[FloatArray, ...]:
        """Return the creases between their ends and crossings, as parameters (k, 2)."""
        ends = self._ends(0)
        reach = CLOSE * float(np.abs(ends[:, 1] - ends[:, 0]).max(axis=1).min())
        curves = [np.column_stack([own, np.zeros(2)]) for own in ends]
        return tuple(chain.points[:, :2] for chain in chains(curves, reach))

    def along_creases(self, spans: FloatArray) -> tuple[FloatArray, FloatArray, IntArray]:
        """Return points along creases, four for every span (2,), as parameters (k, 2) in both faces beside them, (k, 2)."""
        ends = np.stack([self._ends(side) for side in range(2)])
        count = np.ceil(4.0 * (np.abs(ends[0, :, 1] - ends[0, :, 0]) / spans).max(axis=1)).astype(int) + 1
        which = np.repeat(np.arange(len(count)), count)
        t = (np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)) / np.maximum(count - 1, 1)[which]
        left, right = (ends[side, which, 0] + t[:, None] * (ends[side, which, 1] - ends[side, which, 0]) for side in range(2))
        return left, right, self.creases[which, 2:]

    def _ends(self, side: int) -> FloatArray:
        """Return the parameters of both ends of every sharp edge, in the face on one side of it (c, 2, 2)."""
        own = self.creases[:, 2 + side]
        places = [np.argmax(self.faces[own] == self.creases[:, end, None], axis=1) for end in range(2)]
        return np.stack([self.corners[own, place] for place in places], axis=1)


class CutFunctions(NamedTuple):
    """Basis functions whose support falls into several parts between creases: one function for every part.

    References
    ----------
    Hansbo, Hansbo, *A finite element method for the simulation of strong and weak discontinuities in solid mechanics*, 2004,
    doi:10.1016/j.cma.2003.12.041.
    """

    counts: tuple[int, int]  # basis functions in both directions
    wrapped: tuple[int, int]  # those that differ, fewer where a parameter closes
    keys: IntArray  # (k,) number of a function times the number of faces, plus a face that lies in a further part of it; sorted
    further: IntArray  # (k,) the control point of this part
    base: IntArray  # (e,) function of each further control point
    cells: Mask  # (a, b) spans, by their first functions, in which a function is cut
    finder: _Finder

    @property
    def control_count(self) -> int:
        """Number of control points."""
        return self.counts[0] * self.counts[1] + len(self.base)

    def control_points(self, i: IntArray, j: IntArray, faces: IntArray) -> IntArray:
        """Return the control points (k, 4, 4) of functions (k, 4) and (k, 4) in both directions, on faces (k,)."""
        plain = i[:, :, None] * self.counts[1] + j[:, None, :]
        function = (i % self.wrapped[0])[:, :, None] * self.counts[1] + (j % self.wrapped[1])[:, None, :]
        wanted = function * self.finder.count + faces[:, None, None]
        at = np.minimum(np.searchsorted(self.keys, wanted), len(self.keys) - 1)
        return np.where(self.keys[at] == wanted, self.further[at], plain)

    def in_cells(self, knots: list[FloatArray]) -> IntArray:
        """Return the control points (k, 16) in the middle of the spans of cut functions."""
        first = np.nonzero(self.cells)
        middle = np.column_stack([0.5 * (own[k + DEGREE] + own[k + DEGREE + 1]) for own, k in zip(knots, first)])
        i, j = (own[:, None] + np.arange(DEGREE + 1) for own in first)
        return self.control_points(i, j, self.finder.at(middle)).reshape(len(i), (DEGREE + 1) ** 2)

    def faces_at(self, uv: FloatArray, i: IntArray, j: IntArray) -> IntArray:
        """Return the face at every place (k, 2) in the spans of cut functions, any face elsewhere."""
        found = np.zeros(len(uv), np.int64)
        near = self.cells[i[:, 0], j[:, 0]]
        found[near] = self.finder.at(uv[near])
        return found


class _Finder:
    """Finds the face of a plane mesh at places."""

    def __init__(self, corners: FloatArray, shifts: FloatArray):
        self.count = len(corners)
        self.corners = np.concatenate([corners + shift for shift in shifts])
        low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
        self.low, span = low, np.maximum(high - low, 1e-300)
        # Squares of which each holds about two faces.
        side = np.sqrt(2.0 * span.prod() / len(corners))
        self.shape = np.maximum(1, np.round(span / side)).astype(int)
        self.side = span / self.shape
        first, last = (self._squares(ends) for ends in (self.corners.min(axis=1), self.corners.max(axis=1)))
        outside = (self.corners.max(axis=1) < low).any(axis=1) | (self.corners.min(axis=1) > high).any(axis=1)
        size = np.where(outside[:, None], 0, last - first + 1)
        counts = size.prod(axis=1)
        face = np.repeat(np.arange(len(counts)), counts)
        k = np.arange(len(face)) - np.repeat(np.cumsum(counts) - counts, counts)
        width = np.maximum(size[face, 1], 1)
        square = (first[face, 0] + k // width) * self.shape[1] + first[face, 1] + k % width
        order = np.argsort(square, kind="stable")
        self.faces = face[order]
        self.starts = np.searchsorted(square[order], np.arange(self.shape.prod() + 1))
        self.centres = cKDTree(self.corners.mean(axis=1))

    def at(self, uv: FloatArray) -> IntArray:
        """Return the face at every place (k, 2), the nearest one outside the mesh."""
        square = self._squares(uv) @ np.array([self.shape[1], 1])
        count = self.starts[square + 1] - self.starts[square]
        point = np.repeat(np.arange(len(uv)), count)
        face = self.faces[np.arange(len(point)) - np.repeat(np.cumsum(count) - count, count) + self.starts[square][point]]
        inside = _least_weight(self.corners[face], uv[point])
        order = np.lexsort((inside, point))
        last = np.flatnonzero(np.append(np.diff(point[order]) > 0, True)) if len(order) else order
        found = np.full(len(uv), -1)
        found[point[order[last]]] = face[order[last]]
        alone = np.flatnonzero(found < 0)
        if len(alone):
            found[alone] = self.centres.query(uv[alone])[1]
        return found % self.count

    def _squares(self, uv: FloatArray) -> IntArray:
        return np.asarray(np.clip(np.floor((uv - self.low) / self.side), 0, self.shape - 1), dtype=np.int64)


def span_widths(knots: list[FloatArray]) -> FloatArray:
    """Return the width of the widest span in both directions (2,)."""
    return np.array([np.diff(own).max() for own in knots])


def cut_functions(mesh: CreasedMesh, knots: list[FloatArray], closed: Mask) -> CutFunctions:
    """Return the basis functions of a bicubic spline with the parts into which creases divide their supports.

    A function is cut where no path leads around the crease within its support, so that it stays whole around the end of a crease.
    """
    counts = [len(own) - DEGREE - 1 for own in knots]
    wrapped = [count - DEGREE if ring else count for count, ring in zip(counts, closed.tolist())]
    cells = np.zeros(counts, bool)
    keys, further, base = list[IntArray](), list[IntArray](), list[int]()
    total, m = counts[0] * counts[1], len(mesh.faces)
    tiles = [mesh.corners + shift for shift in mesh.shifts]
    lows, highs = [own.min(axis=1) for own in tiles], [own.max(axis=1) for own in tiles]
    left, right, _ = mesh.along_creases(span_widths(knots))
    places = np.concatenate([left + shift for shift in mesh.shifts] + [right + shift for shift in mesh.shifts])
    on = [
        np.searchsorted(own if ring else own[: -DEGREE - 1], places[:, k], side="right") - 1
        for k, (own, ring) in enumerate(zip(knots, closed.tolist()))
    ]
    crossed = {(i - p, j - q) for i, j in set(zip(on[0].tolist(), on[1].tolist())) for p in range(DEGREE + 1) for q in range(DEGREE + 1)}
    for i, j in sorted(own for own in crossed if 0 <= own[0] < wrapped[0] and 0 <= own[1] < wrapped[1]):
        low, high = np.array([knots[0][i], knots[1][j]]), np.array([knots[0][i + DEGREE + 1], knots[1][j + DEGREE + 1]])
        reach = INSIDE * (high - low)
        local, touched = list[IntArray](), list[Mask]()
        for tile, least, most in zip(tiles, lows, highs):
            near = np.flatnonzero(((most > low + reach) & (least < high - reach)).all(axis=1))
            if len(near):
                edges = _reaches_into(tile[near], np.roll(tile[near], -1, axis=1), low + reach, high - reach)
                within = edges.any(axis=1) | (_least_weight(tile[near], 0.5 * (low + high)) > 0.0)
                local.append(near[within])
                touched.append(edges[within])
        if not local:
            continue
        faces, edges = np.concatenate(local), np.concatenate(touched)
        part = _parts(faces, mesh.beside[faces], edges, m)
        if part.max(initial=0) == 0:
            continue
        # The largest part keeps the control point of the whole function.
        order = np.argsort(-np.bincount(part), kind="stable")
        cells[np.ix_(_spans(i, wrapped[0], closed[0]), _spans(j, wrapped[1], closed[1]))] = True
        for number in order[1:].tolist():
            own = np.unique(faces[part == number])
            keys.append((i * counts[1] + j) * m + own)
            further.append(np.full(len(own), total + len(base)))
            base.append(i * counts[1] + j)
    every, points = np.concatenate([*keys, [-1]]), np.concatenate([*further, [-1]])
    order = np.argsort(every, kind="stable")
    finder = _Finder(mesh.corners, mesh.shifts)
    return CutFunctions(
        (counts[0], counts[1]), (wrapped[0], wrapped[1]), every[order], points[order], np.array(base, dtype=np.int64), cells, finder
    )


def _spans(number: int, wrapped: int, ring: bool) -> IntArray:
    """Return the spans in which a function is not zero, by their first function."""
    spans = np.arange(number - DEGREE, number + 1)
    return spans % wrapped if ring else spans[(spans >= 0) & (spans < wrapped - DEGREE)]


def _parts(faces: IntArray, beside: IntArray, edges: Mask, m: int) -> IntArray:
    """Return the part (k,) of every face (k,), where faces are joined across edges (k, 3) that are touched."""
    row, side = np.nonzero(edges & (beside >= 0))
    place = np.full(m, -1)
    place[faces] = np.arange(len(faces))
    # A face that lies in the support twice, a period apart, is one.
    twin = np.column_stack([np.arange(len(faces)), place[faces]])
    pairs = np.column_stack([row, place[beside[row, side]]])
    pairs = np.concatenate([pairs[pairs[:, 1] >= 0], twin])
    graph = sparse.csr_matrix((np.ones(len(pairs)), pairs.T), shape=(len(faces),) * 2)
    return np.asarray(connected_components(graph, directed=False)[1])


def _least_weight(triangles: FloatArray, points: FloatArray) -> FloatArray:
    """Return the least barycentric weight (k,) of points (k, 2) in triangles (k, 3, 2), below zero outside."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    p, q, r = b - a, c - a, points - a
    area = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    area = np.where(area == 0.0, 1e-300, area)
    s = (r[:, 0] * q[:, 1] - r[:, 1] * q[:, 0]) / area
    t = (p[:, 0] * r[:, 1] - p[:, 1] * r[:, 0]) / area
    return np.minimum(np.minimum(s, t), 1.0 - s - t)


def _reaches_into(first: FloatArray, last: FloatArray, low: FloatArray, high: FloatArray) -> Mask:
    """Return which segments (..., 2) have points inside a rectangle, by the method of Liang and Barsky."""
    step = last - first
    safe = np.where(np.abs(step) > 0.0, step, 1e-300)
    one, other = (low - first) / safe, (high - first) / safe
    enter, leave = np.minimum(one, other).max(axis=-1), np.maximum(one, other).min(axis=-1)
    return np.maximum(enter, 0.0) <= np.minimum(leave, 1.0)
