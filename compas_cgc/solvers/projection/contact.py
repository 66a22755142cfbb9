"""Which vertices touch the sides that goals keep them to: the active set."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple
from typing import Optional

import numpy as np
from numpy.typing import NDArray

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.topology import tops
from ...model.constraints import ClosestPoints
from ...model.goals.binding import Side
from ...model.goals.inequalities import Bound
from ...model.tolerances import ROUNDING
from ..constants import LOCAL_ROUNDING

__all__ = ["Contact", "Touching"]

STICKY = 4  # times that a vertex may leave a side; prevents endless changes of the active set


class Touching(NamedTuple):
    """Vertices that touch a side, as a constraint of their places."""

    vertices: Sequence[int]
    side: Bound

    def closest_points(self, points: FloatArray) -> ClosestPoints:
        """Return the nearest points of the side."""
        slack, inwards = self.side.slack(points)
        return ClosestPoints(points - slack[:, None] * inwards, inwards[:, :, None] * inwards[:, None, :])


class Contact(NamedTuple):
    """Of every side, which vertices keep to it, which of them touch it, and how often they have let go."""

    sides: tuple[Side, ...]
    movable: NDArray[np.bool_]  # (n,)
    edges: IntArray  # (e, 2)
    members: tuple[NDArray[np.bool_], ...]  # (n,) each
    touching: tuple[NDArray[np.bool_], ...]  # (n,) each
    released: tuple[NDArray[np.int_], ...]  # (n,) each

    @classmethod
    def none(cls, sides: Sequence[Side], movable: NDArray[np.bool_], edges: IntArray) -> Contact:
        """Return the contact of a shape that touches nothing."""
        nobody, never = np.zeros(len(movable), bool), np.zeros(len(movable), np.int64)
        return cls(tuple(sides), movable, edges, (nobody,) * len(sides), (nobody,) * len(sides), (never,) * len(sides))

    def constraints(self) -> list[Touching]:
        """Return the places of the vertices that touch."""
        return [Touching(np.flatnonzero(own).tolist(), side.goal) for side, own in zip(self.sides, self.touching) if own.any()]

    def crossed(self, vertices: FloatArray) -> FloatArray:
        """Return how far every vertex of a shape (n, 3) is on the wrong side of something (n,)."""
        far = np.zeros(len(vertices))
        for side, member in zip(self.sides, self.members):
            at = np.union1d(side.candidates(vertices), np.flatnonzero(member))
            far[at] = np.maximum(far[at], -side.goal.slack(vertices[at])[0])
        return far

    def at(self, vertices: FloatArray) -> Contact:
        """Return the contact in which all vertices of a shape (n, 3) touch that are on a side to rounding."""
        touching, members = [], []
        for side in self.sides:
            now, own = np.zeros(len(self.movable), bool), np.zeros(len(self.movable), bool)
            at = side.candidates(vertices)
            own[at] = True
            now[at] = (np.abs(side.goal.slack(vertices[at])[0]) <= ROUNDING) & self.movable[at]
            touching.append(now)
            members.append(own)
        return self._replace(members=tuple(members), touching=tuple(touching))

    def renewed(self, vertices: FloatArray, force: Optional[FloatArray]) -> Contact:
        """Return the contact at a shape (n, 3) that forces (n, 3) push: the gradient of the Lagrangian, None where it is not known.

        A vertex that has crossed a side touches it from then on, and lets go where it would have to be pulled: the
        primal-dual active set method (Hintermüller, Ito and Kunisch, doi:10.1137/S1052623401383558). Whoever has let go a
        few times does so no more, so that it ends.
        """
        members, touching, released = [], [], []
        largest = 0.0 if force is None else float(np.abs(force).max(initial=0.0))
        for side, member, before, times in zip(self.sides, self.members, self.touching, self.released):
            own = member.copy()
            own[side.candidates(vertices)] = True
            at = np.flatnonzero(own)
            slack, inwards = side.goal.slack(vertices[at])
            now = before.copy()
            if force is not None:
                pressed = np.einsum("ij,ij->i", inwards, force[at]) > ROUNDING * largest
                now[at] &= pressed | (times[at] >= STICKY)
            now |= self._worst(at, -slack)
            members.append(own)
            touching.append(now)
            released.append(times + (before & ~now))
        return self._replace(members=tuple(members), touching=tuple(touching), released=tuple(released))

    def _worst(self, at: IntArray, crossed: FloatArray) -> NDArray[np.bool_]:
        """Return the vertices (n,) that have crossed a side further than their neighbours; these may come back with them.

        A surface that is curved lies against a side along lines or at points: to lay all of it there at once would crumple it.
        """
        far = np.zeros(len(self.movable))
        far[at] = np.where(self.movable[at], crossed, 0.0)
        return (far > LOCAL_ROUNDING) & tops(far, self.edges)

    def same(self, other: Contact) -> bool:
        """Return whether the same vertices touch."""
        return all(np.array_equal(one, two) for one, two in zip(self.touching, other.touching))
