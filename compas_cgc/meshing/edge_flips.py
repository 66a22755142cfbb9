"""Edge flips: replacing the common edge of two triangles by the other diagonal."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.plan import cross

__all__ = ["Diagonals", "diagonals", "edges_with_counts", "flipped", "flipped_to_valence", "turn", "valences"]

SWEEPS = 60
LOW_VALENCE_COST = 10


class Diagonals(NamedTuple):
    """Inner edges from a to b, with the opposite corners c and d."""

    one: IntArray  # (k,) the triangle of c
    other: IntArray  # (k,) the triangle of d
    a: IntArray  # (k,)
    b: IntArray  # (k,)
    c: IntArray  # (k,)
    d: IntArray  # (k,)

    def turned(self) -> tuple[IntArray, IntArray]:
        """Return the two triangles (k, 3) after a flip of each edge."""
        return np.column_stack([self.a, self.d, self.c]), np.column_stack([self.d, self.b, self.c])


def diagonals(n: int, faces: IntArray, kept: IntArray) -> Diagonals:
    """Return the inner edges of triangles (m, 3) on n vertices without those in `kept` (lower end * n + higher end)."""
    u, v, w = faces.ravel(), np.roll(faces, -1, axis=1).ravel(), np.roll(faces, 1, axis=1).ravel()
    key = np.minimum(u, v) * n + np.maximum(u, v)
    order = np.argsort(key, kind="stable")
    pair = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    e, f = order[pair], order[pair + 1]
    free = ~np.isin(key[e], kept)
    e, f = e[free], f[free]
    return Diagonals(e // 3, f // 3, u[e], v[e], w[e], w[f])


def flipped(plan: FloatArray, faces: IntArray, kept: IntArray, gain: Callable[[Diagonals], FloatArray]) -> IntArray:
    """Return triangles (m, 3) after flips with positive gain, largest first, that invert no triangle in plan (n, 2)."""
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
    """Return triangles (m, 3) on n vertices after allowed flips that bring valences nearer to 6.

    An inner vertex with fewer than `fewest` edges has an extra cost of LOW_VALENCE_COST per missing edge.
    """
    faces = faces.copy()

    def cost(excess: IntArray) -> IntArray:
        return np.asarray(excess**2 + LOW_VALENCE_COST * np.maximum(fewest - 6 - excess, 0))

    inner = np.ones(n)
    edges, count = edges_with_counts(faces)
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
        # Flips that share a vertex are done one at a time, because their gains depend on each other.
        touched = np.zeros(n, bool)
        for k in np.flatnonzero(good)[np.argsort((after - before)[good], kind="stable")].tolist():
            if not touched[quad[k]].any():
                touched[quad[k]] = True
                faces[one[k]], faces[other[k]] = (a[k], d[k], c[k]), (d[k], b[k], c[k])
    return faces


def valences(n: int, faces: IntArray) -> IntArray:
    """Return the number of edges at every vertex (n,)."""
    return np.bincount(edges_with_counts(faces)[0].ravel(), minlength=n)


def edges_with_counts(faces: IntArray) -> tuple[IntArray, IntArray]:
    """Return the edges (e, 2) of triangles, sorted, and the number of faces (e,) of each."""
    u, v = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    n = int(faces.max(initial=0)) + 1
    # Codes sort ten times as fast as rows.
    code, count = np.unique(np.minimum(u, v) * n + np.maximum(u, v), return_counts=True)
    return np.column_stack(np.divmod(code, n)), count


def turn(plan: FloatArray, a: IntArray, b: IntArray, c: IntArray) -> FloatArray:
    """Return twice the areas (k,) of triangles in plan (n, 2), positive if counterclockwise."""
    return cross(plan[b] - plan[a], plan[c] - plan[a])
