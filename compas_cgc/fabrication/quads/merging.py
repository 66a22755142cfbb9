"""Removal of small polygons along the rim."""

from __future__ import annotations

from typing import Optional

import numpy as np

from ...discrete.arrays import Vectors
from .extraction import Polygons

__all__ = ["merged"]


def merged(own: Polygons, shortest: float) -> Polygons:
    """Return polygons without sides at the rim below a length [L]; lines then meet the rim in a common vertex.

    A crossing of lines close to the rim comes to lie on it. Kinks of the rim and irregular vertices stay. A side stays as well if its
    removal would let a polygon touch itself.
    """
    points, faces = own.vertices.copy(), [list(face) for face in own.faces]
    while True:
        found = _shortest(own, points, faces, shortest)
        if found is None:
            break
        points, faces = found
    used = np.unique(np.concatenate([np.array(face, np.int64) for face in faces]))
    place = np.zeros(len(points), np.int64)
    place[used] = np.arange(len(used))
    return Polygons(points[used], [place[face].tolist() for face in faces], own.rim[used], own.kinks[used])


def _shortest(own: Polygons, points: Vectors, faces: list[list[int]], shortest: float) -> Optional[tuple[Vectors, list[list[int]]]]:
    """Return points and faces after the removal of the shortest removable side, None if there is none."""
    uses: dict[tuple[int, int], int] = {}
    degree: dict[int, int] = {}
    for face in faces:
        for a, b in zip(face, face[1:] + face[:1]):
            uses[min(a, b), max(a, b)] = uses.get((min(a, b), max(a, b)), 0) + 1
    for a, b in uses:
        degree[a], degree[b] = degree.get(a, 0) + 1, degree.get(b, 0) + 1
    sides = sorted((float(np.linalg.norm(points[a] - points[b])), a, b) for a, b in uses if own.rim[a] or own.rim[b])
    for length, a, b in sides:
        if length >= shortest:
            return None
        # The first vertex is kept: a kink, or else one on the rim.
        a, b = sorted((a, b), key=lambda each: (not own.kinks[each], not own.rim[each], each))
        across = own.rim[a] and own.rim[b] and uses[min(a, b), max(a, b)] == 2
        if own.kinks[b] or across or (not own.rim[b] and degree[b] != 4):
            continue
        changed = [_replaced(face, a, b) for face in faces]
        if not own.rim[b]:
            # A line that met the rim at the third corner of a vanishing triangle meets it at the crossing, which now lies there.
            passed = [vertex for vertex in _vanishing(faces, changed) - {a, b} if degree[vertex] == 3 and not own.kinks[vertex]]
            changed = [[vertex for vertex in face if vertex not in passed] for face in changed]
        # Another inner corner of a vanishing face would lose a side, and a line would end there.
        if not own.rim[list(_vanishing(faces, changed) - {a, b})].all():
            continue
        if any(len(set(face)) < len(face) for face in changed):
            continue
        if own.rim[b] and not own.kinks[a]:
            points[a] = 0.5 * (points[a] + points[b])
        return points, [face for face in changed if len(face) > 2]
    return None


def _replaced(face: list[int], kept: int, removed: int) -> list[int]:
    """Return a polygon with one vertex in place of another, without consecutive repetitions."""
    own = [kept if vertex == removed else vertex for vertex in face]
    return [vertex for vertex, before in zip(own, own[-1:] + own[:-1]) if vertex != before]


def _vanishing(faces: list[list[int]], changed: list[list[int]]) -> set[int]:
    """Return the corners of polygons that are left with fewer than three corners."""
    return {vertex for face, left in zip(faces, changed) if len(left) < 3 for vertex in face}
