"""Polygons between the integer lines of a parametrisation."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ...discrete import edge_faces
from ...discrete import vertex_normals
from ...discrete.arrays import Faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Mask
from ...discrete.arrays import Vectors
from ...discrete.arrays import Vertices

__all__ = ["Polygons", "extracted"]

ONE_POINT = 1e-6  # of the spacing, within which points are one


class Polygons(NamedTuple):
    """A polygon mesh on a region."""

    vertices: Vectors  # (k, 3) [L]
    faces: list[list[int]]  # corners of every polygon, counterclockwise
    rim: Mask  # (k,) on the rim of the region
    kinks: Mask  # (k,) at kinks of the rim


def extracted(vertices: Vertices, faces: Faces, uv: FloatArray, spacing: float, kinks: IntArray) -> Polygons:
    """Return the polygons between the integer lines of coordinates (m, 3, 2) and the rim.

    The lines are cut at their crossings and at mesh edges; the pieces and the rim form a graph on the surface, whose cycles around
    vertices are the polygons. Vertices where a line merely passes are left out.
    """
    places, pieces = _pieces(vertices, faces, uv)
    rim_edges = edge_faces(faces)
    rim_edges = rim_edges[rim_edges[:, 3] < 0]
    near = cKDTree(places).query_pairs(ONE_POINT * spacing, output_type="ndarray")
    count, label = connected_components(sparse.coo_matrix((np.ones(len(near)), near.T), shape=(len(places),) * 2), directed=False)
    points = np.zeros((count, 3))
    points[label[::-1]] = places[::-1]
    inner = np.unique(np.sort(label[pieces], axis=1), axis=0)
    inner = inner[inner[:, 0] != inner[:, 1]]
    tree = cKDTree(points)
    ahead: list[tuple[int, int]] = []
    for a, b in vertices[rim_edges[:, :2]]:
        ahead += _along_edge(points, tree, a, b, ONE_POINT * spacing)
    rim_pairs = np.array(ahead)
    backwards = {(b, a) for a, b in ahead}
    whole = np.unique(np.sort(np.vstack([inner, rim_pairs]), axis=1), axis=0)
    normals = vertex_normals(vertices, faces)[cKDTree(vertices).query(points)[1]]
    cycles = _cycles(points, normals, whole)
    cycles = [cycle for cycle in cycles if not any(pair in backwards for pair in zip(cycle, cycle[1:] + cycle[:1]))]
    degree = np.bincount(whole.ravel(), minlength=count)
    kink = np.zeros(count, bool)
    kink[tree.query(vertices[kinks])[1]] = True
    on_rim = np.zeros(count, bool)
    on_rim[rim_pairs.ravel()] = True
    kept = (degree != 2) | kink
    polygons = [[vertex for vertex in cycle if kept[vertex]] for cycle in cycles]
    used = np.unique(np.concatenate([np.array(own, np.int64) for own in polygons]))
    place = np.zeros(count, np.int64)
    place[used] = np.arange(len(used))
    return Polygons(points[used], [place[own].tolist() for own in polygons], on_rim[used], kink[used])


def _pieces(vertices: Vertices, faces: Faces, uv: FloatArray) -> tuple[Vectors, IntArray]:
    """Return points (k, 3), the vertices of the mesh and those on integer lines, and pieces of lines between points (s, 2)."""
    places: list[FloatArray] = [vertices[np.unique(faces)]]
    count, pieces = len(places[0]), []
    for corners, own in zip(vertices[faces], uv):
        for axis in (0, 1):
            for line in _lines(corners, own, axis):
                places.append(line)
                pieces += [(count + k, count + k + 1) for k in range(len(line) - 1)]
                count += len(line)
    return np.vstack(places), np.array(pieces, dtype=np.int64).reshape(-1, 2)


def _lines(corners: FloatArray, uv: FloatArray, axis: int) -> list[Vectors]:
    """Return the pieces of integer lines of a coordinate in a face, as their ends and the integers of the other coordinate (k, 3)."""
    own, other = uv[:, axis], uv[:, 1 - axis]
    found = []
    for level in range(int(np.ceil(own.min())), int(np.floor(own.max())) + 1):
        on = [k for k in range(3) if own[k] == level]
        crossed = [k for k in range(3) if (own[k] - level) * (own[(k + 1) % 3] - level) < 0.0]
        weights = [np.eye(3)[k] for k in on]
        for k in crossed:
            share = (level - own[k]) / (own[(k + 1) % 3] - own[k])
            weights.append((1.0 - share) * np.eye(3)[k] + share * np.eye(3)[(k + 1) % 3])
        if len(weights) != 2:
            continue
        start, end = sorted(weights, key=lambda each: float(each @ other))
        low, high = float(start @ other), float(end @ other)
        inner = [t for t in range(int(np.ceil(low)), int(np.floor(high)) + 1) if low < t < high]
        shares = [0.0, *((t - low) / (high - low) for t in inner), 1.0]
        found.append(np.array([((1.0 - t) * start + t * end) @ corners for t in shares]))
    return found


def _along_edge(points: Vectors, tree: cKDTree, a: FloatArray, b: FloatArray, near: float) -> list[tuple[int, int]]:
    """Return pairs of consecutive points on an edge from a to b."""
    along = b - a
    length = float(np.linalg.norm(along))
    found = np.array(tree.query_ball_point(0.5 * (a + b), 0.5 * length + near), dtype=np.int64)
    share = (points[found] - a) @ along / length**2
    off = np.linalg.norm(points[found] - a - share[:, None] * along, axis=1)
    on = off <= near
    order = found[on][np.argsort(share[on], kind="stable")].tolist()
    return list(zip(order[:-1], order[1:]))


def _cycles(points: Vectors, normals: Vectors, pairs: IntArray) -> list[list[int]]:
    """Return the cycles of a graph drawn on a surface that run counterclockwise around its faces."""
    around: dict[int, list[tuple[float, int]]] = {}
    for a, b in [*map(tuple, pairs.tolist()), *map(tuple, pairs[:, ::-1].tolist())]:
        normal = normals[a]
        x = np.eye(3)[int(np.argmin(np.abs(normal)))]
        x = x - (x @ normal) * normal
        along = points[b] - points[a]
        around.setdefault(a, []).append((float(np.arctan2(np.cross(normal, x) @ along, x @ along)), b))
    before: dict[tuple[int, int], int] = {}
    for a, own in around.items():
        own.sort()
        # The face to the left of a half-edge into a vertex leaves it along the next one clockwise.
        for (_, b), (_, c) in zip(own, own[1:] + own[:1]):
            before[c, a] = b
    cycles, left = [], set(before)
    for start in sorted(before):
        if start not in left:
            continue
        cycle, at = [], start
        while at in left:
            left.remove(at)
            cycle.append(at[0])
            at = at[1], before[at]
        cycles.append(cycle)
    return cycles
