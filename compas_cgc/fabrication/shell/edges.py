"""Edges of regions: the paths of mesh edges along which regions end or meet, between corners and crossings."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from ...discrete.arrays import Faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Vertices

__all__ = ["CORNER", "RegionEdge", "loops_of", "region_edges"]

CORNER = np.radians(30.0)  # turn of a boundary that makes a corner
_Edge = tuple[int, int]


class RegionEdge(NamedTuple):
    """A smooth edge of one or two regions."""

    path: IntArray  # (k,) vertices from one end to the other
    regions: tuple[int, ...]  # the region or the two regions beside it


def region_edges(vertices: Vertices, faces: Faces, label: IntArray, ends: Iterable[int] = ()) -> list[RegionEdge]:
    """Return the edges of all regions; a closed edge without corners is divided in two.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` triangles.
    label
        ``(m,)`` region of every face.
    ends
        Further vertices at which edges end.
    """
    beside: dict[_Edge, list[int]] = {}
    for own, (a, b, c) in zip(label.tolist(), faces.tolist()):
        for i, j in ((a, b), (b, c), (c, a)):
            beside.setdefault((min(i, j), max(i, j)), []).append(own)
    sides = {edge: tuple(sorted(set(own))) for edge, own in beside.items() if len(own) == 1 or own[0] != own[1]}
    at: dict[int, list[_Edge]] = {}
    for edge in sorted(sides):
        for vertex in edge:
            at.setdefault(vertex, []).append(edge)
    nodes = {v for v, own in at.items() if len(own) != 2 or sides[own[0]] != sides[own[1]] or _turn(vertices, v, *own) > CORNER}
    nodes.update(vertex for vertex in ends if vertex in at)
    left, edges = set(sides), []
    for vertex in sorted(nodes):
        for edge in at[vertex]:
            if edge in left:
                edges.append(RegionEdge(np.array(_walk(vertex, edge, at, nodes, left)), sides[edge]))
    while left:
        edge = min(left)
        ring = _walk(edge[0], edge, at, nodes, left)
        half = len(ring) // 2
        edges += [RegionEdge(np.array(part), sides[edge]) for part in (ring[: half + 1], ring[half:])]
    return edges


def loops_of(edges: list[RegionEdge], own: list[int]) -> list[list[int]]:
    """Return some edges, those of a region, in the order of its boundary loops."""
    left, loops = list(own), []
    while left:
        loop = [left.pop(0)]
        start, here = edges[loop[0]].path[[0, -1]].tolist()
        while here != start:
            k = next(k for k in left if here in edges[k].path[[0, -1]])
            left.remove(k)
            loop.append(k)
            first, last = edges[k].path[[0, -1]].tolist()
            here = last if here == first else first
        loops.append(loop)
    return loops


def _walk(vertex: int, edge: _Edge, at: dict[int, list[_Edge]], nodes: set[int], left: set[_Edge]) -> list[int]:
    """Return the path that begins with an edge and ends at a node or at its own beginning; remove it from `left`."""
    path = [vertex]
    while True:
        left.discard(edge)
        path.append(edge[1] if edge[0] == path[-1] else edge[0])
        following = [other for other in at[path[-1]] if other in left]
        if path[-1] in nodes or not following:
            return path
        edge = following[0]


def _turn(vertices: Vertices, vertex: int, first: _Edge, second: _Edge) -> float:
    """Return the angle by which two edges at a vertex turn [rad]."""
    back, ahead = (vertices[edge[0] + edge[1] - vertex] - vertices[vertex] for edge in (first, second))
    cosine: FloatArray = -(back @ ahead) / (np.linalg.norm(back) * np.linalg.norm(ahead))
    return float(np.arccos(np.clip(cosine, -1.0, 1.0)))
