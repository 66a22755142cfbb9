"""Flips of edges: two triangles of one edge become those of the other diagonal."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.plan import cross

__all__ = ["Diagonals", "diagonals", "flipped", "flipped_to_valence", "turn", "valences"]

SWEEPS = 60
SEVERAL = 10


class Diagonals(NamedTuple):
    """Edges between two triangles, from a to b, with the corners c and d opposite."""

    one: IntArray  # (k,) the triangle of c
    other: IntArray  # (k,) that of d
    a: IntArray  # (k,)
    b: IntArray  # (k,)
    c: IntArray  # (k,)
    d: IntArray  # (k,)

    def turned(self) -> tuple[IntArray, IntArray]:
        """Return the two triangles (k, 3) there are when an edge is turned."""
        return np.column_stack([self.a, self.d, self.c]), np.column_stack([self.d, self.b, self.c])


def diagonals(n: int, faces: IntArray, kept: IntArray) -> Diagonals:
    """Return the inner edges of triangles (m, 3) on n vertices, without those kept, numbered by lower end * n + higher end."""
    u, v, w = faces.ravel(), np.roll(faces, -1, axis=1).ravel(), np.roll(faces, 1, axis=1).ravel()
    key = np.minimum(u, v) * n + np.maximum(u, v)
    order = np.argsort(key, kind="stable")
    pair = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    e, f = order[pair], order[pair + 1]
    free = ~np.isin(key[e], kept)
    e, f = e[free], f[free]
    return Diagonals(e // 3, f // 3, u[e], v[e], w[e], w[f])


def flipped(plan: FloatArray, faces: IntArray, kept: IntArray, gain: Callable[[Diagonals], FloatArray]) -> IntArray:
    """Return triangles (m, 3) after flips that gain something, the largest gains first, and turn none over in plan (n, 2)."""
    faces = faces.copy()
    for _ in range(SWEEPS):
        edges = diagonals(len(plan), faces, kept)
        gains = gain(edges)
        a, b, c, d = edges[2:]
        good = (gains > 0) & (turn(plan, a, d, c) > 0) & (turn(plan, d, b, c) > 0)
        if not good.any():
            break
        busy = np.zeros(len(faces), bool)
        for k in np.flatnonzero(good)[np.argsort(-gains[good], kind="stable")].tolist():
            one, other = edges.one[k], edges.other[k]
            if not busy[one] and not busy[other]:
                busy[one] = busy[other] = True
                faces[one], faces[other] = (a[k], d[k], c[k]), (d[k], b[k], c[k])
    return faces


def flipped_to_valence(
    n: int, faces: IntArray, kept: IntArray, allowed: Callable[[IntArray, Diagonals], Mask], fewest: int = 0
) -> IntArray:
    """Return triangles (m, 3) on n vertices after flips that bring valences nearer to 6, and are allowed of triangles and edges.

    An inner vertex with less than the `fewest` edges counts for several that are one off.
    """
    faces = faces.copy()

    def cost(excess: IntArray) -> IntArray:
        return np.asarray(excess**2 + SEVERAL * np.maximum(fewest - 6 - excess, 0))

    inner = np.ones(n)
    sides = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    edges, count = np.unique(sides, axis=0, return_counts=True)
    inner[edges[count == 1]] = 0.0
    for _ in range(SWEEPS):
        free = diagonals(n, faces, kept)
        one, other, a, b, c, d = free
        excess = valences(n, faces) - 6
        quad, steps = np.column_stack([a, b, c, d]), np.array([-1, -1, 1, 1])
        before = (inner[quad] * cost(excess[quad])).sum(axis=1)
        after = (inner[quad] * cost(excess[quad] + steps)).sum(axis=1)
        good = (after < before) & allowed(faces, free)
        if not good.any():
            break
        # One at a time where they share a vertex: their gains are not independent.
        touched = np.zeros(n, bool)
        for k in np.flatnonzero(good)[np.argsort((after - before)[good], kind="stable")].tolist():
            if not touched[quad[k]].any():
                touched[quad[k]] = True
                faces[one[k]], faces[other[k]] = (a[k], d[k], c[k]), (d[k], b[k], c[k])
    return faces


def valences(n: int, faces: IntArray) -> IntArray:
    """Return the number of edges at every vertex (n,)."""
    edges = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
    return np.bincount(edges.ravel(), minlength=n)


def turn(plan: FloatArray, a: IntArray, b: IntArray, c: IntArray) -> FloatArray:
    """Return twice the areas (k,) of triangles in plan (n, 2), positive where they run anticlockwise."""
    return cross(plan[b] - plan[a], plan[c] - plan[a])
