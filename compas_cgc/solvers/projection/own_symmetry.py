"""The symmetries that a drawing has of itself, with all that is asked of it, and those of them that its surface keeps."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations
from typing import Optional

import numpy as np
from scipy.spatial import cKDTree

from ...discrete import edge_faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...model.constraints import Mirror
from ...model.constraints import Proximity
from ...model.goals.binding import BoundGoals
from ...model.goals.binding import bind
from ...model.goals.binding import unknown_regions
from ...model.goals.wholes import Length
from ...model.problem import CGCProblem
from .placement import Places
from .placement import movable_vertices
from .symmetry import MOST
from .symmetry import Image
from .symmetry import images
from .symmetry import keep_faces
from .symmetry import together

__all__ = ["colours", "kept_symmetries", "mirrors_and_own", "own_symmetries"]

EXACT = 1e-7  # distance of an image from its vertex relative to the size; meshes in Rhino may have single precision, 6e-8
# distance of a surface from its image relative to the size, below which symmetry is intended; half and twice it give the same surfaces
NEAR = 2e-3
# distance from its image relative to the size, up to which a surface is symmetric; 45 rounding errors of a turned coordinate
SYMMETRIC = 1e-14
PROBES = 12  # vertices that are checked before all are [vertices]; most candidates fail at one of the first


def own_symmetries(problem: CGCProblem, goals: BoundGoals) -> list[Image]:
    """Return the turns and mirrorings that take a drawing to itself, the identity first.

    They take faces to faces, supports to supports, targets to targets and goals to goals. A mesh has few of them, as the image of
    one face tells them: those of the rarest faces, by their distances from the middle, are tried.
    """
    identity = Image(np.arange(len(problem.vertices)), np.eye(3), np.zeros(3))
    if any(isinstance(own, (Mirror, Length, Proximity)) for own in problem.goals):
        return [identity]
    faces = problem.faces[problem.real_faces]
    used = np.unique(faces)
    if len(used) < len(problem.vertices):
        return [identity]
    V = problem.vertices
    middle = V.mean(axis=0)
    arms = V - middle
    size = float(np.linalg.norm(arms, axis=1).max())
    colour = colours(problem)
    tree, rule = cKDTree(arms), _Rule(problem, goals, colour)
    found = [identity]
    for turn in _turns(arms, faces, colour):
        if any(np.allclose(turn, known.turn, rtol=0.0, atol=1e-5) for known in found):
            continue
        to = _matched(tree, arms, turn, EXACT * size)
        if to is None or any(np.array_equal(to, known.to) for known in found):
            continue
        image = Image(to, turn, middle - turn @ middle)
        if rule.allows(image) and keep_faces(faces, [identity, image]):
            found.append(image)
        if len(found) > MOST:
            return [identity]
    return found


def mirrors_and_own(problem: CGCProblem) -> list[Image]:
    """Return the symmetries that the mirrors of a problem make together with those that its drawing has of itself."""
    mirrors = [constraint for constraint in problem.goals if isinstance(constraint, Mirror)]
    others = replace(problem, goals=tuple(own for own in problem.goals if not isinstance(own, Mirror)))
    edges = edge_faces(problem.faces)
    edge = float(np.linalg.norm(problem.vertices[edges[:, 0]] - problem.vertices[edges[:, 1]], axis=1).mean())
    made = [*images(problem.vertices, edge, mirrors), *own_symmetries(others, bind(others))]
    return together(made[1:], len(problem.vertices))


def kept_symmetries(vertices: FloatArray, size: float, symmetries: list[Image]) -> Optional[list[Image]]:
    """Return those symmetries of the drawing that a surface (n, 3) has nearly, None where they are no group or need no help.

    A saddle over a square has fewer than the square; those that it has lost are its own affair.
    """
    gaps = [_gap(vertices, image) for image in symmetries]
    kept = [image for image, gap in zip(symmetries, gaps) if gap <= NEAR * size]
    if len(kept) < 2 or max(gap for gap in gaps if gap <= NEAR * size) <= SYMMETRIC * size:
        return None
    known = {tuple(image.to.tolist()) for image in kept}
    closed = all(tuple(one.to[other.to].tolist()) in known for one in kept for other in kept)
    return kept if closed else None


def _gap(vertices: FloatArray, image: Image) -> float:
    moved = vertices @ image.turn.T + image.shift
    return float(np.abs(moved - vertices[image.to]).max())


def colours(problem: CGCProblem) -> IntArray:
    """Return a number of every vertex (n,), the same where role, target, valence and distance from the middle are."""
    radius = np.linalg.norm(problem.vertices - problem.vertices.mean(axis=0), axis=1)
    radius /= radius.max()
    valence = np.bincount(problem.faces.ravel(), minlength=len(radius))
    unknown = np.zeros(len(radius))
    for region in unknown_regions(problem):
        unknown[problem.region_vertices(region)] = 1.0
    targets = np.where(problem.asked & (unknown == 0.0), np.nan_to_num(problem.targets), 0.0)
    keys = np.column_stack([problem.roles, targets, valence, unknown, np.round(radius / (100.0 * EXACT))])
    return np.unique(keys, axis=0, return_inverse=True)[1].ravel()


def _turns(arms: FloatArray, faces: IntArray, colour: IntArray) -> Iterator[FloatArray]:
    """Yield the turns and mirrorings about the middle (3, 3) that take one of the rarest faces to another."""
    kinds = np.sort(colour[faces], axis=1)
    _, first, group, count = np.unique(kinds, axis=0, return_index=True, return_inverse=True, return_counts=True)
    if count.min() > MOST:
        return
    rarest = int(np.argmin(count))
    start = faces[first[rarest]]
    own = _frame(arms[start])
    if own is None:
        return
    for face in faces[group.ravel() == rarest].tolist():
        for corners in permutations(face):
            if (colour[list(corners)] != colour[start]).any():
                continue
            other = _frame(arms[list(corners)])
            if other is None:
                continue
            both = [other * [1.0, 1.0, side] @ own.T for side in (1.0, -1.0)]
            # Of two that say the same of a flat drawing the one that leaves up where it is.
            yield from sorted(both, key=lambda turn: -turn[2, 2])


def _frame(corners: FloatArray) -> Optional[FloatArray]:
    """Return orthonormal columns (3, 3) along the first side of a triangle, across it and upright, None without area."""
    along, side = corners[1] - corners[0], corners[2] - corners[0]
    normal = np.cross(along, side)
    length, area = float(np.linalg.norm(along)), float(np.linalg.norm(normal))
    if not (length > 0.0 and area > 1e-12 * length**2):
        return None
    along, normal = along / length, normal / area
    frame: FloatArray = np.column_stack([along, np.cross(normal, along), normal]).astype(np.float64)
    return frame


def _matched(tree: cKDTree, arms: FloatArray, turn: FloatArray, reach: float) -> Optional[IntArray]:
    """Return the vertex at the image of every one (n,), None where one has none."""
    probes = np.linspace(0, len(arms) - 1, min(PROBES, len(arms))).astype(np.int64)
    if (tree.query(arms[probes] @ turn.T, distance_upper_bound=reach)[0] > reach).any():
        return None
    distance, to = tree.query(arms @ turn.T, distance_upper_bound=reach)
    if (distance > reach).any() or len(np.unique(to)) < len(to):
        return None
    return to.astype(np.int64)


class _Rule:
    """What a symmetry of a problem has to keep besides the vertices."""

    def __init__(self, problem: CGCProblem, goals: BoundGoals, colour: IntArray):
        V = problem.vertices
        movable = movable_vertices(problem, problem.faces)
        identity = Image(np.arange(len(V)), np.eye(3), np.zeros(3))
        self._vertices, self._movable, self._colour = V, movable, colour
        self._bound, self._pull = Places(V, movable, goals.places, [identity]).conditions(V)
        self._goals, self._creases = goals, {tuple(sorted(edge)) for edge in problem.creases.tolist()}

    def allows(self, image: Image) -> bool:
        """Return whether a symmetry takes roles, targets, creases, constraints and goals to themselves."""
        to, turn = image.to, image.turn
        if (self._colour[to] != self._colour).any() or (self._movable[to] != self._movable).any():
            return False
        if {tuple(sorted(to[list(edge)].tolist())) for edge in self._creases} != self._creases:
            return False
        if not np.allclose(self._bound[to], turn @ self._bound @ turn.T, atol=1e-6):
            return False
        if not np.allclose(self._pull[to], self._pull @ turn.T, atol=1e-6):
            return False
        if self._goals.equations and turn[2, 2] < 1.0 - 1e-9:
            return False
        for side in self._goals.sides:
            at = side.candidates(self._vertices)
            if not np.array_equal(np.sort(to[at]), np.sort(at)):
                return False
            here, there = (side.goal.slack(self._vertices[own])[0] for own in (at, to[at]))
            if not np.allclose(here, there, atol=1e-6):
                return False
        return True
