"""Straight supported edges along which K < 0 requires a twist that contradicts the corners at their ends."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

import numpy as np

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.corners import corner_angles
from ..errors import Remedy
from ..errors import Sentence
from ..meshing import boundary_loops
from .inward_edges import MIN_CORNER
from .problem import CGCProblem
from .roles import FIXED
from .tolerances import DRAWING_ACCURACY

__all__ = ["twisted_edges"]

MIN_TWIST_ERROR = np.radians(8.0)  # difference of twists above which corners fold [rad]; visible as VISIBLE_KINK of the verdict


class _Side(NamedTuple):
    """A straight supported part of the boundary between two corners of supported edges."""

    ends: tuple[int, int]
    length: float  # [L]
    twist: float  # from the tangent plane at one end to that at the other, 0 to π [rad]
    target: float  # K̄ beside it [1/L^2]

    @property
    def off(self) -> float:
        """Difference between the twist required by K, modulo full turns and sign, and the twist between the corners [rad]."""
        asked = float(np.sqrt(-self.target)) * self.length
        return float(abs(np.arccos(np.clip(np.cos(asked), -1.0, 1.0)) - self.twist))


def twisted_edges(problem: CGCProblem) -> list[str]:
    r"""Return a sentence about the straight supported edge whose twist contradicts its corners the most, empty if there is none.

    A straight line in a surface is an asymptotic line, along which the tangent plane turns by :math:`\sqrt{-K}` per unit length
    (Beltrami-Enneper theorem). At a corner of supported edges the tangent plane is the plane of both edges.
    """
    sides = [side for loop in boundary_loops(problem.faces) for side in _sides(problem, loop)]
    worst = max(sides, key=lambda side: side.off, default=None)
    if worst is None or not worst.off > MIN_TWIST_ERROR:
        return []
    (a, b), names = worst.ends, problem.names.vertices
    digits = 2 - int(np.floor(np.log10(np.linalg.norm(np.ptp(problem.vertices, axis=0)))))
    places = [", ".join(f"{round(number, digits) + 0.0:g}" for number in problem.vertices[v, :2].tolist()) for v in (a, b)]
    asked = np.degrees(np.sqrt(-worst.target)) * worst.length
    fits = -((worst.twist / worst.length) ** 2) + 0.0
    text = (
        f"along the straight supported edge from vertex {names[a]} ({places[0]}) to {names[b]} ({places[1]}), length {worst.length:.3g}, "
        f"a surface of K = {worst.target:.3g} twists by {asked:.0f} degrees, but the supported edges at its ends require "
        f"{np.degrees(worst.twist):.0f} degrees: the surface will fold at its corners; free or bend one of these edges, or set K = "
        f"{fits:.3g} there"
    )
    return [Sentence(text, [Remedy("targets", float(f"{fits:.3g}"))])]


def _sides(problem: CGCProblem, loop: IntArray) -> list[_Side]:
    """Return the straight sides of a boundary loop, with the surface to its left, between corners of supported edges."""
    V, held = problem.vertices, problem.roles == FIXED
    along = np.roll(V[loop], -1, axis=0) - V[loop]
    length = np.linalg.norm(along, axis=1)
    if len(loop) < 4 or not (length > 0.0).all():
        return []
    unit = along / length[:, None]
    before = np.roll(unit, 1, axis=0)
    turn = np.linalg.norm(np.cross(before, unit), axis=1)
    on = held[loop] & held[np.roll(loop, -1)]
    corner = (turn > np.sin(MIN_CORNER)) & on & np.roll(on, 1) & ~np.isin(loop, problem.creases)
    found = []
    for first in np.flatnonzero(corner).tolist():
        last, total = first, 0.0
        while True:
            total += float(length[last % len(loop)])
            last += 1
            here = last % len(loop)
            if corner[here] or not on[here] or turn[here] > DRAWING_ACCURACY or here == first or np.isin(loop[here], problem.creases):
                break
        if corner[here] and here != first:
            side = _side(problem, loop, first, here, total, unit)
            if side is not None:
                found.append(side)
    return found


def _side(problem: CGCProblem, loop: IntArray, first: int, last: int, length: float, unit: FloatArray) -> Optional[_Side]:
    span = loop[first : last + 1] if last > first else np.append(loop[first:], loop[: last + 1])
    beside = np.unique(problem.faces[np.isin(problem.faces, span[1:-1] if len(span) > 2 else span).any(axis=1)])
    asked = problem.targets[beside[problem.asked[beside]]]
    if not len(asked) or not np.isfinite(asked).all() or np.ptp(asked) > 0.0 or asked[0] >= 0.0:
        return None
    # Directions into the surface, across the side: those of the edges before and after it.
    ways = (-unit[first - 1], unit[last])
    inwards = []
    for vertex, way in zip((loop[first], loop[last]), ways):
        across = way - (way @ unit[first]) * unit[first]
        inwards.append(across / np.linalg.norm(across) * (1.0 if _angle(problem, int(vertex)) < np.pi else -1.0))
    twist = float(np.arctan2(np.linalg.norm(np.cross(*inwards)), inwards[0] @ inwards[1]))
    return _Side((int(loop[first]), int(loop[last])), length, twist, float(asked[0]))


def _angle(problem: CGCProblem, vertex: int) -> float:
    """Return the angle of the surface at a vertex [rad]."""
    own = problem.faces[(problem.faces == vertex).any(axis=1)]
    return float(corner_angles(problem.vertices, own)[own == vertex].sum())
