"""Creases as edges and as vertex paths."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Sequence

import numpy as np

from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import Mask
from ..errors import names_what_was_meant

__all__ = ["crease_paths", "lost_edges", "path_edges"]


@names_what_was_meant()
def path_edges(paths: Iterable[Sequence[int]]) -> list[tuple[int, int]]:
    """Return the edges along vertex paths, without duplicates, in order.

    Parameters
    ----------
    paths
        Paths of vertices; an edge is a path of two.

    Returns
    -------
    list of tuple
        Pairs of vertices.

    Examples
    --------
    >>> path_edges([[0, 1, 2], [2, 1]])
    [(0, 1), (1, 2)]
    """
    edges: dict[tuple[int, int], None] = {}
    for path in paths:
        for u, v in zip(path[:-1], path[1:]):
            u, v = int(u), int(v)
            if (v, u) not in edges:
                edges[u, v] = None
    return list(edges)


@names_what_was_meant()
def crease_paths(edges: Iterable[tuple[int, int]]) -> list[list[int]]:
    """Return edges joined to the longest paths between ends and junctions.

    Parameters
    ----------
    edges
        Pairs of vertices.

    Returns
    -------
    list of list of int
        Vertex paths, ordered by their smallest edge; a closed path ends where it begins.

    Examples
    --------
    >>> crease_paths([(0, 1), (1, 2), (5, 6)])
    [[0, 1, 2], [5, 6]]
    """
    around: dict[int, list[int]] = {}
    for u, v in edges:
        around.setdefault(u, []).append(v)
        around.setdefault(v, []).append(u)
    for others in around.values():
        others.sort()
    used: set[tuple[int, int]] = set()
    paths = []
    ends = sorted(v for v, others in around.items() if len(others) != 2)
    # Open paths start at ends and junctions; the rest are closed.
    for start in ends + sorted(around):
        for after in around[start]:
            if (start, after) in used:
                continue
            path = [start]
            u, v = start, after
            while (u, v) not in used:
                used.update(((u, v), (v, u)))
                path.append(v)
                if len(around[v]) != 2:
                    break
                first, second = around[v]
                u, v = v, (second if first == u else first)
            paths.append(path)
    return sorted(paths, key=lambda path: min(sorted(pair) for pair in zip(path[:-1], path[1:])))


@names_what_was_meant()
def lost_edges(faces: Faces, pairs: Edges) -> Mask:
    """Return which pairs of vertices (c, 2) are not edges of the faces (m, 3), as (c,) bool.

    Parameters
    ----------
    faces
        ``(m, 3)`` triangles.
    pairs
        ``(c, 2)`` vertices.

    Returns
    -------
    (c,) bool
        True for pairs that are not edges.

    Examples
    --------
    >>> lost_edges(np.array([[0, 1, 2], [0, 2, 3]]), np.array([[0, 2], [1, 3]])).tolist()
    [False, True]
    """
    if not len(pairs):
        return np.zeros(0, bool)
    n = int(max(faces.max(initial=0), pairs.max(initial=0))) + 1
    u, v = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    return ~np.isin(np.sort(pairs, axis=1) @ [n, 1], np.minimum(u, v) * n + np.maximum(u, v))
