"""Goals as conditions on a surface whose vertices move along fixed directions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy import sparse

from ...discrete import edge_faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Mask
from ...discrete.topology import tops
from ...model.constraints import Fixed
from ...model.constraints import Height
from ...model.constraints import PositionConstraint
from ...model.goals.binding import bind
from ...model.goals.binding import support_height
from ...model.goals.inequalities import Above
from ...model.goals.inequalities import Below
from ...model.goals.inequalities import Bound
from ...model.goals.places import Level
from ...model.goals.wholes import Rise
from ...model.goals.wholes import Whole
from ...model.problem import CGCProblem
from ...model.tolerances import NEGLIGIBLE
from ...model.tolerances import ROUNDING

__all__ = ["Conditions", "Met"]


class Met(NamedTuple):
    """How a surface meets conditions, in the local frame."""

    places: FloatArray  # (k,) distances along the directions from the places of vertices
    place_slopes: FloatArray  # (k, 2) their derivatives by the moves of the vertices they are about
    values: FloatArray  # (c,) of quantities zero where they are as wanted, of sides not negative where they are kept
    slopes: sparse.csr_matrix  # (c, n) their derivatives by the moves
    one_sided: Mask  # (c,) sides

    @property
    def missed(self) -> FloatArray:
        """By what quantities and sides are missed (c,)."""
        return np.where(self.one_sided, np.minimum(self.values, 0.0), self.values)

    @property
    def is_met(self) -> bool:
        """Whether all are, but for rounding."""
        return bool(np.abs(self.places).max(initial=0.0) <= ROUNDING and np.abs(self.missed).max(initial=0.0) <= ROUNDING)


class Conditions:
    """Places, quantities and sides that the goals of a problem set to the moves of its vertices.

    Parameters
    ----------
    problem
        In its local frame, without dummies.
    directions
        ``(n, 3)`` unit vectors along which vertices move.
    """

    def __init__(self, problem: CGCProblem, directions: FloatArray):
        goals, V = bind(problem), problem.vertices
        self._directions = problem.movable[:, None] * directions
        self._quantities = goals.equations
        self._places = [(own, np.asarray(own.vertices, np.int64)) for own in goals.places]
        self._sides = [*((own.goal, own.candidates(V)) for own in goals.sides), *_beside_crowns(problem)]
        self._edges = edge_faces(problem.faces)[:, :2]
        pairs = [_pairs(own, at) for own, at in self._places]
        self.vertices = np.concatenate([np.zeros((0, 2), np.int64), *pairs])  # that places are about, -1 for one alone (k, 2)
        self._touching = np.concatenate([np.zeros(0, np.int64), *(at for _, at in self._sides)])
        # What moves do not change is met, or cannot be.
        self._placed, self._kept = np.ones(len(self.vertices), bool), np.ones(len(self._touching), bool)
        self._nothing: Optional[Met] = None
        met = self.at(V)
        self._placed = np.abs(met.place_slopes).max(axis=1, initial=0.0) > NEGLIGIBLE
        self._kept = np.asarray(abs(met.slopes).sum(axis=1)).ravel()[met.one_sided] > NEGLIGIBLE
        self.can_be_met = (
            all(isinstance(own, (Whole, Bound, PositionConstraint, Fixed)) for own in problem.goals)
            and all((_place(own, V[at], self._directions[at])[2] <= NEGLIGIBLE).all() for own, at in self._places)
            and bool((met.values[met.one_sided][~self._kept] >= -NEGLIGIBLE).all())
        )
        self.vertices, self._touching = self.vertices[self._placed], self._touching[self._kept]
        self._nothing = None if self.count else self.at(V)

    @property
    def count(self) -> int:
        """Number of conditions."""
        return len(self.vertices) + len(self._quantities) + len(self._touching)

    @property
    def lone(self) -> IntArray:
        """Vertices with a place of their own."""
        return self.vertices[self.vertices[:, 1] < 0, 0]

    def at(self, vertices: FloatArray) -> Met:
        """Return how a surface (n, 3) meets them."""
        if self._nothing is not None:
            return self._nothing
        V, D, n = vertices, self._directions, len(vertices)
        placed = [(np.zeros(0), np.zeros((0, 2))), *(_place(own, V[at], D[at])[:2] for own, at in self._places)]
        places, place_slopes = (np.concatenate(parts)[self._placed] for parts in zip(*placed))
        whole = np.array([own.value(V) - own.wanted for own in self._quantities], dtype=np.float64)
        gradients = np.array([np.einsum("ni,ni->n", own.gradient(V), D) for own in self._quantities]).reshape(len(whole), n)
        beside = [(np.zeros(0), np.zeros((0, 3))), *(side.slack(V[at]) for side, at in self._sides)]
        slack, inwards = (np.concatenate(parts)[self._kept] for parts in zip(*beside))
        touching = _rows(self._touching, np.einsum("ki,ki->k", inwards, D[self._touching]), n)
        values = np.concatenate([whole, slack])
        slopes = sparse.vstack([sparse.csr_matrix(gradients), touching], format="csr")
        return Met(places, place_slopes, values, slopes, np.arange(len(values)) >= len(whole))

    def pushes_along(self, vertices: FloatArray, forces: FloatArray, moves: FloatArray) -> FloatArray:
        """Return the derivative (n,) of what quantities push with, of forces (c,), along moves (n,) of a surface (n, 3)."""
        along, total = moves[:, None] * self._directions, np.zeros(vertices.shape)
        for own, force in zip(self._quantities, forces):
            total += force * own.curvature_along(vertices, along)
        return np.asarray(np.einsum("ni,ni->n", total, self._directions))

    def worst(self, missed: FloatArray) -> Mask:
        """Return the sides among quantities and sides that are missed (c,), by more than beside any neighbour.

        A curved surface touches a side at points or along lines: to lay all of it there at once would crumple it.
        """
        behind = -missed[len(self._quantities) :]
        far = np.zeros(len(self._directions))
        np.maximum.at(far, self._touching, behind)
        found = (behind > 0.0) & (behind >= far[self._touching]) & tops(far, self._edges)[self._touching]
        return np.concatenate([np.zeros(len(self._quantities), bool), found])


def _rows(at: IntArray, values: FloatArray, n: int) -> sparse.csr_matrix:
    """Return rows (k, n) with one value (k,) each, at a vertex (k,)."""
    return sparse.csr_matrix((values, (np.arange(len(at)), at)), shape=(len(at), n))


def _pairs(place: PositionConstraint, at: IntArray) -> IntArray:
    """Return the vertices (k, 2) of the conditions that a place sets to vertices."""
    if isinstance(place, Level):
        return np.column_stack([at[1:], at[:-1]])
    return np.column_stack([at, np.full(len(at), -1)])


def _place(place: PositionConstraint, points: FloatArray, directions: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the distances (k,) of points (p, 3) from a place along directions (p, 3), their slopes (k, 2), and those aside (p,)."""
    closest, normal = place.closest_points(points)
    along, away = np.einsum("kij,kj->ki", normal, directions), points - closest
    if isinstance(place, Level):
        # Heights equal to their mean are one condition fewer than vertices.
        up = directions[:, 2]
        aside = np.abs(np.hstack([along, away[:, :2]])).max(axis=1)
        return np.diff(points[:, 2]), np.column_stack([up[1:], -up[:-1]]), aside
    size = np.linalg.norm(along, axis=1)
    unit = along / np.maximum(size, NEGLIGIBLE)[:, None]
    distance = np.einsum("ki,ki->k", away, unit)
    return distance, np.column_stack([size, np.zeros_like(size)]), np.linalg.norm(away - distance[:, None] * unit, axis=1)


def _beside_crowns(problem: CGCProblem) -> Iterator[tuple[Bound, IntArray]]:
    """Yield, for heights of crowns, the side that all vertices keep to: of several highest ones the quantity is one's alone."""
    everywhere = np.arange(len(problem.vertices))
    for own in problem.goals:
        if isinstance(own, Rise):
            height = support_height(problem) + own.rise
            yield (Below(height) if own.rise > 0.0 else Above(height)), everywhere
        elif isinstance(own, Height) and isinstance(own.vertices, str):
            yield Below(own.height), everywhere
