"""Saddles at vertices of four faces: the last step to K < 0 on irregular meshes.

Four faces have angles of more than 2π between them only where their edges go up and down by turns. On a saddle whose axes lie
otherwise no small move of such a vertex changes its angles towards that, so least-norm steps come to rest beside it. Then its star is
folded the other way by itself: the vertex comes between the two diagonals of its neighbours, and these apart as far as it takes.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Callable
from typing import Optional

import numpy as np

from ...discrete.arrays import Faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import Vertices
from ...discrete.jacobian import CurvatureEquations
from ...discrete.space_form import space_form_angle_sums
from .gauss_newton import FULFILLED
from .gauss_newton import Taken
from .gauss_newton import descend_to_rounding
from .iterate import Point
from .system import System

__all__ = ["descend_over_saddles"]

ROUNDS = 6  # of folding stars and of steps after it
SHORT, MANY_SHORT = 0.5, 4  # so many steps in a row below this part say that a vertex is stuck
STUCK = 0.1  # part of the largest residual, from which a vertex is stuck
INSIDE = 0.1  # part of a diagonal within which the vertex stays off its ends
FIRST, FARTHEST = 1e-3, 0.3  # parts of a diagonal by which the two are drawn apart
HALVINGS = 40


def descend_over_saddles(system: System, equations: CurvatureEquations, start: Point) -> Iterator[Taken]:
    """Take steps from a start to rounding; where they come to rest at vertices of four faces, fold these and go on."""
    here = start
    for _ in range(ROUNDS):
        short, reached = 0, here.vertices
        for taken in descend_to_rounding(system, equations, here):
            reached = taken.vertices
            yield taken
            short = short + 1 if taken.length < SHORT else 0
            if short == MANY_SHORT:
                break
        here = system.at(reached, equations)
        if system.missing(here, equations) <= FULFILLED:
            return
        if not system.places.trivial or len(here.residual) != len(system.rows):
            break
        folded = _folded(system, equations, here)
        if folded is None:
            break
        here = system.at(folded, equations)
        yield Taken(folded, 1.0, 1, False)
    yield from descend_to_rounding(system, equations, here)


def _folded(system: System, equations: CurvatureEquations, point: Point) -> Optional[Vertices]:
    """Return the shape (n, 3) with the stars of stuck vertices folded, those of the largest residual first; None where none is."""
    faces, rows, targets = system.faces, system.rows, equations.targets
    valence = np.bincount(faces.ravel(), minlength=len(point.vertices))
    stuck = (valence[rows] == 4) & (targets[rows] < 0.0) & (point.residual > STUCK * np.abs(point.residual).max(initial=0.0))
    order = np.flatnonzero(stuck)[np.argsort(-point.residual[stuck], kind="stable")]
    free = np.zeros(len(valence), bool)
    free[system.columns] = True
    vertices = point.vertices.copy()
    for vertex in rows[order].tolist():
        own = faces[(faces == vertex).any(axis=1)]
        star = np.array([vertex, *_ring(own, vertex)])
        if not free[star].all():
            continue
        places = _saddle(vertices[star], np.searchsorted(np.sort(star), own), np.argsort(star), float(targets[vertex]))
        if places is not None:
            vertices[star] = places
            # Neighbours are folded in another round, if they still have to be.
            free[star] = False
    return None if (vertices == point.vertices).all() else vertices


def _ring(faces: Faces, vertex: int) -> list[int]:
    """Return the neighbours around a vertex of four faces, in their order."""
    after = {}
    for face in faces.tolist():
        at = face.index(vertex)
        after[face[(at + 1) % 3]] = face[(at + 2) % 3]
    ring = [next(iter(after))]
    while len(ring) < 4:
        ring.append(after[ring[-1]])
    return ring


def _saddle(star: FloatArray, ranks: Faces, order: np.ndarray, K: float) -> Optional[FloatArray]:
    """Return places (5, 3) of a vertex and its four neighbours with angles that add up to what K asks for, None where there are none.

    ``ranks`` (4, 3) are the faces by the rank of their vertices, and ``order`` (5,) the vertices by rank.
    """
    corners = order[ranks]
    targets = np.zeros(5)
    targets[0] = K
    first, second = star[3] - star[1], star[4] - star[2]
    across = np.cross(first, second)
    long = float(np.linalg.norm(first))
    if not np.linalg.norm(across) > 0.0:
        return None
    across = across / np.linalg.norm(across)
    s, t = np.clip(np.linalg.lstsq(np.column_stack([first, -second]), star[2] - star[1], rcond=None)[0], INSIDE, 1.0 - INSIDE)
    apart = float((star[2] + t * second - star[1] - s * first) @ across)
    side = np.array([0.0, -0.5, 0.5, -0.5, 0.5])[:, None] * (across if apart >= 0.0 else -across)

    def between(part: float, gap: float) -> FloatArray:
        places = star + gap * side
        middle = 0.5 * (places[1] + s * (places[3] - places[1]) + places[2] + t * (places[4] - places[2]))
        places[0] += part * (middle - places[0])
        return places

    def lacks(places: FloatArray) -> bool:
        return bool(space_form_angle_sums(places, corners, targets)[0] < 2 * np.pi)

    if not lacks(between(1.0, 0.0)):
        return _least(lambda part: between(part, 0.0), lacks, 1.0)
    gap = FIRST * long
    while lacks(between(1.0, gap)):
        gap *= 2.0
        if gap > FARTHEST * long:
            return None
    return _least(lambda own: between(1.0, own), lacks, gap)


def _least(places: Callable[[float], FloatArray], lacks: Callable[[FloatArray], bool], most: float) -> FloatArray:
    """Return the places for the least number up to `most` that lack nothing."""
    low, high = 0.0, most
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if lacks(places(middle)) else (low, middle)
    return places(high)
