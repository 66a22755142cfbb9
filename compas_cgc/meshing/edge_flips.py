"""Flips of edges: two triangles of one edge become those of the other diagonal."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.plan import cross

__all__ = ["Diagonals", "diagonals", "flipped", "turn"]

SWEEPS = 60


class Diagonals(NamedTuple):
    """Edges between two triangles, from a to b, with the corners c and d opposite."""

    one: IntArray  # (k,) the triangle of c
    other: IntArray  # (k,) that of d
    a: IntArray  # (k,)
    b: IntArray  # (k,)
    c: IntArray  # (k,)
    d: IntArray  # (k,)


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


def turn(plan: FloatArray, a: IntArray, b: IntArray, c: IntArray) -> FloatArray:
    """Return twice the areas (k,) of triangles in plan (n, 2), positive where they run anticlockwise."""
    return cross(plan[b] - plan[a], plan[c] - plan[a])
