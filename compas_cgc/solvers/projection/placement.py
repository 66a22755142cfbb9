"""In which directions the vertices may move, and how far they are from where they must be."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...errors import ProblemError
from ...model.constraints import PositionConstraint
from ...model.constraints import indices
from ...model.goals.places import Level
from ...model.problem import CGCProblem
from ...model.tolerances import DRAWING_ACCURACY
from ...model.tolerances import NEGLIGIBLE
from .contact import Touching
from .symmetry import Image

__all__ = ["Freedoms", "Places", "movable_vertices"]


class Freedoms(NamedTuple):
    """What constraints leave of the moves of the movable vertices."""

    basis: Optional[sparse.csr_matrix]  # (3c, q) free directions, None for all
    owner: IntArray  # (q,) the vertex that a direction belongs to, and its images
    gap: Optional[FloatArray]  # (c, 3) moves onto the constraints, None without any

    def across(self, normals: FloatArray) -> sparse.csr_matrix:
        """Return (q, p) the free direction nearest to the normals (3c,), one for every vertex that has any."""
        part = normals if self.basis is None else self.basis.T @ normals
        _, first, group = np.unique(self.owner, return_index=True, return_inverse=True)
        length = np.sqrt(np.bincount(group, part**2))
        part = part / np.where(length > NEGLIGIBLE, length, 1.0)[group]
        part[first[length <= NEGLIGIBLE]] = 1.0
        return sparse.csr_matrix((part, (np.arange(len(part)), group)), shape=(len(part), len(first)))


class Places:
    """The constraints on places, gathered vertex by vertex.

    A symmetry makes one unknown of a vertex and all its images: the first of them stands
    for the others and takes on their constraints, as they look from its place.

    Parameters
    ----------
    start
        ``(n, 3)`` coordinates of the start.
    movable
        ``(n,)`` vertices that may move at all.
    constraints
        Constraints that place vertices.
    symmetries
        Symmetries of the start, the identity first.

    Raises
    ------
    ProblemError
        If a constraint names a vertex that is not there or that is fixed elsewhere.
    """

    def __init__(
        self, start: FloatArray, movable: NDArray[np.bool_], constraints: Sequence[PositionConstraint], symmetries: Sequence[Image]
    ):
        n = len(start)
        self.start = start
        self.movable = movable
        self.constraints: list[tuple[IntArray, Union[PositionConstraint, Touching]]] = [
            (indices(constraint.vertices, n), constraint) for constraint in constraints
        ]
        self.symmetries = symmetries
        self._always = self.constraints
        # A level edge that is bound besides, to a height, is level without being one.
        self.rings = [at for at, constraint in self.constraints if isinstance(constraint, Level) and movable[at].all()]
        self.trivial = not constraints and len(symmetries) == 1
        self.head = np.arange(n)
        self.turn, self.shift = np.tile(np.eye(3), (n, 1, 1)), np.zeros((n, 3))
        for image in symmetries[1:]:
            new = np.flatnonzero(np.arange(n) < self.head[image.to])
            later = image.to[new]
            self.head[later], self.turn[later], self.shift[later] = new, image.turn, image.shift
        self._by_symmetry: Optional[tuple[FloatArray, FloatArray, sparse.csr_matrix, IntArray]] = None
        self._all = Freedoms(None, np.repeat(np.flatnonzero(movable), 3), None)
        self._refuse_astray()

    def holding(self, more: Sequence[Touching]) -> Places:
        """Return the same places with more constraints, instead of those that were held so before."""
        places = copy.copy(self)
        n = len(self.start)
        places.constraints = [*self._always, *((indices(constraint.vertices, n), constraint) for constraint in more)]
        places.trivial = not places.constraints and len(self.symmetries) == 1
        return places

    def symmetric_vectors(self, vectors: FloatArray) -> FloatArray:
        """Return vectors (n, 3) averaged over the symmetries."""
        return np.mean([vectors[image.to] @ image.turn for image in self.symmetries], axis=0)

    def gap(self, vertices: FloatArray) -> FloatArray:
        """Return how far every vertex of a shape (n, 3) is from fulfilling its constraints (n,)."""
        gap = np.zeros(len(vertices))
        if len(self.symmetries) > 1:
            gap = np.linalg.norm(self.symmetric(vertices) - vertices, axis=1)
        for at, constraint in self.constraints:
            gap[at] = np.maximum(gap[at], np.linalg.norm(constraint.closest_points(vertices[at]).points - vertices[at], axis=1))
        return gap

    def freedoms(self, vertices: FloatArray) -> Freedoms:
        """Return what may move at a shape (n, 3)."""
        if self.trivial:
            return self._all
        goal = self.symmetric(vertices)
        bound, pull = self.conditions(goal)
        at = np.flatnonzero(bound.any(axis=(1, 2)))
        # Symmetries alone bind the same directions at every shape.
        known = None if self.constraints else self._by_symmetry
        value, vector = np.linalg.eigh(bound[at]) if known is None else known[:2]
        shift = _shortest(value, vector, pull[at], at, len(vertices))
        for ring in self.rings:
            shift[ring, 2] += goal[ring, 2].mean() - goal[ring, 2]
        goal = self._from_heads(goal + shift)
        basis, owner = self._basis(value, vector, at) if known is None else known[2:]
        if not self.constraints:
            self._by_symmetry = value, vector, basis, owner
        return Freedoms(basis, owner, (goal - vertices)[np.flatnonzero(self.movable)])

    def _basis(self, value: FloatArray, vector: FloatArray, at: IntArray) -> tuple[sparse.csr_matrix, IntArray]:
        """Return the free directions (3c, q) where some vertices are bound, and the vertices that they belong to (q,)."""
        n, columns = len(self.start), np.flatnonzero(self.movable)
        free, direction = np.ones((n, 3), bool), np.tile(np.eye(3), (n, 1, 1))
        free[at], direction[at] = value <= NEGLIGIBLE, vector
        heads = self.head[columns]
        live = np.zeros(n, bool)
        live[heads] = True
        owned = free & live[:, None]
        number = self._numbered(owned, direction)
        count = int(number.max(initial=-1)) + 1
        place, k = np.nonzero(free[heads])
        moves = np.einsum("pxy,py->px", self.turn[columns[place]], direction[heads[place], :, k])
        rows = 3 * place[:, None] + np.arange(3)
        columns_of = np.repeat(number[heads[place], k], 3)
        basis = sparse.csr_matrix((moves.ravel(), (rows.ravel(), columns_of)), shape=(3 * len(columns), count))
        owner = np.empty(count, dtype=np.int64)
        owner[number[owned][::-1]] = np.nonzero(owned)[0][::-1]
        return basis, owner

    def _numbered(self, owned: NDArray[np.bool_], direction: FloatArray) -> IntArray:
        """Return the number of every free direction (n, 3), -1 of others; the upright ones of a level edge are made one."""
        number = np.full(owned.shape, -1)
        number[owned] = np.arange(np.count_nonzero(owned))
        for ring in self.rings:
            vertex, k = np.nonzero(owned[ring])
            at = ring[vertex]
            direction[at, :, k] *= np.where(direction[at, 2, k] < 0.0, -1.0, 1.0)[:, None]
            number[at, k] = number[at[:1], k[:1]] if len(at) else -1
        if self.rings:
            number[owned] = np.unique(number[owned], return_inverse=True)[1]
        return number

    def symmetric(self, vertices: FloatArray) -> FloatArray:
        """Return the nearest symmetric shape (n, 3)."""
        back = [(vertices[image.to] - image.shift) @ image.turn for image in self.symmetries]
        return self._from_heads(np.mean(back, axis=0))

    def _from_heads(self, points: FloatArray) -> FloatArray:
        return np.einsum("nxy,ny->nx", self.turn, points[self.head]) + self.shift

    def conditions(self, vertices: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the sums at the heads of projectors (n, 3, 3) onto, and of pulls (n, 3) along, the directions that are bound."""
        bound, pull = np.zeros((len(vertices), 3, 3)), np.zeros((len(vertices), 3))
        if len(self.symmetries) > 1:
            bound[~self.movable] = np.eye(3)
            pull[~self.movable] = (self.start - vertices)[~self.movable]
        for at, constraint in self.constraints:
            feet = constraint.closest_points(vertices[at])
            bound[at] += feet.normal
            pull[at] += np.einsum("kxy,ky->kx", feet.normal, feet.points - vertices[at])
        if len(self.symmetries) == 1:
            return bound, pull
        total, toward = np.zeros_like(bound), np.zeros_like(pull)
        np.add.at(total, self.head, np.einsum("nyx,nyz,nzw->nxw", self.turn, bound, self.turn))
        np.add.at(toward, self.head, np.einsum("nyx,ny->nx", self.turn, pull))
        for image in self.symmetries[1:]:
            itself = np.flatnonzero(image.to == np.arange(len(vertices)))
            stay = np.eye(3) - image.turn
            total[itself] += stay.T @ stay
            toward[itself] += (image.shift - vertices[itself] @ stay.T) @ stay
        return total, toward

    def _refuse_astray(self) -> None:
        gap = np.where(self.movable, 0.0, self.gap(self.start))
        if (gap > DRAWING_ACCURACY).any():
            vertex = int(np.argmax(gap))
            kind = next((type(own).__name__ for at, own in self.constraints if vertex in at), "constraint")
            raise ProblemError(
                [f"vertex {vertex} is fixed, but not where a constraint requires it; free it, or remove it from the goal {kind}"]
            )


def _shortest(value: FloatArray, vector: FloatArray, pull: FloatArray, at: IntArray, n: int) -> FloatArray:
    """Return the shortest moves (n, 3) that fulfil the conditions of some vertices, by their principal values and directions."""
    held = value > NEGLIGIBLE
    along = np.einsum("nxk,nx->nk", vector, pull)
    shift = np.zeros((n, 3))
    shift[at] = np.einsum("nxk,nk->nx", vector, np.where(held, along / np.where(held, value, 1.0), 0.0))
    return shift


def movable_vertices(problem: CGCProblem, faces: IntArray) -> NDArray[np.bool_]:
    """Mark the vertices of some faces (m, 3) that may move at all (n,)."""
    used = np.zeros(len(problem.vertices), bool)
    used[faces.ravel()] = True
    return problem.movable & used
