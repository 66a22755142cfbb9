"""Removal of small polygons along the rim."""

from __future__ import annotations

from typing import Optional

import numpy as np

from .extraction import Polygons

__all__ = ["merged"]


def merged(own: Polygons, shortest: float) -> Polygons:
    """Return polygons without sides at the rim below a length [L]; lines then meet the rim in a common vertex.

    A crossing of lines closer to the rim than that comes to lie on it. Kinks of the rim and irregular vertices stay. A side stays as well
    if its removal would let a polygon touch itself.
    """
    left: Optional[Polygons] = own
    while left is not None:
        own = left
        left = _without_flat_triangle(own, shortest) or _without_short_side(own, shortest)
    used = np.unique(np.concatenate([np.array(face, np.int64) for face in own.faces]))
    place = np.zeros(len(own.vertices), np.int64)
    place[used] = np.arange(len(used))
    return Polygons(own.vertices[used], [place[face].tolist() for face in own.faces], own.rim[used], own.kinks[used])


def _without_flat_triangle(own: Polygons, shortest: float) -> Optional[Polygons]:
    """Return polygons without one triangle between the rim and a crossing close to it, which comes to lie on the rim."""
    uses, degree = _counted(own.faces)
    for number, face in enumerate(own.faces):
        inner = [corner for corner in face if not own.rim[corner]]
        if len(face) != 3 or len(inner) != 1 or degree[inner[0]] != 4:
            continue
        at = face.index(inner[0])
        crossing, a, b = face[at], face[at - 2], face[at - 1]
        along, away = own.vertices[b] - own.vertices[a], own.vertices[crossing] - own.vertices[a]
        share = min(max(float(away @ along) / float(along @ along), 0.0), 1.0)
        foot = own.vertices[a] + share * along
        if uses[min(a, b), max(a, b)] > 1 or np.linalg.norm(own.vertices[crossing] - foot) >= shortest:
            continue
        # Lines that met the rim beside the crossing now end there.
        passed = [corner for corner in (a, b) if degree[corner] == 3 and not own.kinks[corner]]
        if (share == 0.0 and a not in passed) or (share == 1.0 and b not in passed):
            continue
        others = own.faces[:number] + own.faces[number + 1 :]
        faces = [[corner for corner in other if corner not in passed] for other in others]
        vanishing = {corner for other, left in zip(others, faces) if len(left) < 3 for corner in other}
        # Another inner corner of a vanishing triangle would lose a side, and a line would end there.
        if not own.rim[list(vanishing - {crossing})].all():
            continue
        points, rim = own.vertices.copy(), own.rim.copy()
        points[crossing], rim[crossing] = foot, True
        return own._replace(vertices=points, faces=[left for left in faces if len(left) > 2], rim=rim)
    return None


def _without_short_side(own: Polygons, shortest: float) -> Optional[Polygons]:
    """Return polygons without the shortest removable side, None if there is none."""
    points, faces = own.vertices, own.faces
    uses, degree = _counted(faces)
    sides = sorted((float(np.linalg.norm(points[a] - points[b])), a, b) for a, b in uses if own.rim[a] or own.rim[b])
    for length, a, b in sides:
        if length >= shortest:
            return None
        # The first vertex is kept: a kink, or else one on the rim.
        a, b = sorted((a, b), key=lambda each: (not own.kinks[each], not own.rim[each], each))
        across = own.rim[a] and own.rim[b] and uses[min(a, b), max(a, b)] == 2
        if own.kinks[b] or across or (not own.rim[b] and degree[b] != 4):
            continue
        # An inner corner of a vanishing triangle would lose a side, and a line would end there.
        if any(len(face) == 3 and {a, b} < set(face) and not own.rim[face].all() for face in faces):
            continue
        changed = [_replaced(face, a, b) for face in faces]
        if any(len(set(face)) < len(face) for face in changed):
            continue
        if own.rim[b] and not own.kinks[a]:
            points = points.copy()
            points[a] = 0.5 * (points[a] + points[b])
        return own._replace(vertices=points, faces=[face for face in changed if len(face) > 2])
    return None


def _counted(faces: list[list[int]]) -> tuple[dict[tuple[int, int], int], dict[int, int]]:
    """Return how many polygons share each side, with the lower corner first, and how many sides meet at each corner."""
    uses: dict[tuple[int, int], int] = {}
    degree: dict[int, int] = {}
    for face in faces:
        for a, b in zip(face, face[1:] + face[:1]):
            uses[min(a, b), max(a, b)] = uses.get((min(a, b), max(a, b)), 0) + 1
    for a, b in uses:
        degree[a], degree[b] = degree.get(a, 0) + 1, degree.get(b, 0) + 1
    return uses, degree


def _replaced(face: list[int], kept: int, removed: int) -> list[int]:
    """Return a polygon with one vertex in place of another, without consecutive repetitions."""
    own = [kept if vertex == removed else vertex for vertex in face]
    return [vertex for vertex, before in zip(own, own[-1:] + own[:-1]) if vertex != before]
