"""Steps in supported boundaries, which a smooth surface cannot follow."""

from __future__ import annotations

import numpy as np

from ..discrete import edge_faces
from ..discrete.arrays import TINY
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from .problem import CGCProblem
from .roles import FIXED

__all__ = ["stepped_edges"]

# smallest turn of the boundary at both ends of a step [rad]; drawn steps turn by 45° and more, slopes by less than 20°
MIN_TURN = np.radians(30.0)
# smallest angle between the planes of these turns [rad]; half of the right angle of a step in elevation to a corner in plan
MIN_PLANE_ANGLE = np.radians(45.0)


def stepped_edges(problem: CGCProblem) -> list[str]:
    """Return a sentence about the steepest step of the supported boundaries, empty if there is none.

    Where its boundary turns, a surface is tangent to the plane of the turn. If the planes at the two ends of a step differ, the
    surface has to fold over a single mesh edge, whatever its curvature.
    """
    V, F, held = problem.vertices, problem.faces, problem.roles == FIXED
    edges = edge_faces(F)
    rim = edges[edges[:, 3] < 0, :2]
    after, before = np.full(len(V), -1), np.full(len(V), -1)
    after[rim[:, 0]], before[rim[:, 1]] = rim[:, 1], rim[:, 0]
    start, end = rim.T
    row = np.column_stack([before[start], start, end, after[end]])
    folded = np.zeros(len(V), bool)
    folded[problem.creases.ravel()] = True
    row = row[(row >= 0).all(axis=1) & held[row].all(axis=1) & ~folded[row[:, 1:3]].all(axis=1)]
    if not len(row) or len(np.unique(rim[:, 0])) < len(rim):
        return []
    turns, across = _turns(V, row)
    stepped = (turns > MIN_TURN).all(axis=1) & (across > MIN_PLANE_ANGLE)
    if not stepped.any():
        return []
    k = int(np.argmax(np.where(stepped, turns.min(axis=1), 0.0)))
    (_, a, b, _), (first, second) = row[k].tolist(), np.degrees(turns[k])
    names = problem.names.vertices
    digits = 2 - int(np.floor(np.log10(np.linalg.norm(np.ptp(V, axis=0)))))
    x, y = (round(number, digits) + 0.0 for number in V[a, :2].tolist())
    return [
        f"the supported boundary has a step of {abs(V[b, 2] - V[a, 2]):.3g} in height from vertex {names[a]} ({x:g}, {y:g}) to the next, "
        f"{names[b]}, with turns of {first:.0f} and {second:.0f} degrees in planes {np.degrees(across[k]):.0f} degrees apart; a smooth "
        "surface cannot follow it: spread the step over more edges, or draw creases to both of its ends"
    ]


def _turns(V: FloatArray, row: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return the turns (k, 2) at the inner vertices of rows of four (k, 4), and the angles (k,) between the planes of the turns [rad]."""
    sides = np.diff(V[row], axis=1)
    crosses = np.cross(sides[:, :-1], sides[:, 1:])
    sines = np.linalg.norm(crosses, axis=2)
    turns = np.arctan2(sines, np.einsum("kij,kij->ki", sides[:, :-1], sides[:, 1:]))
    cosines = np.abs(np.einsum("ki,ki->k", crosses[:, 0], crosses[:, 1])) / np.maximum(sines.prod(axis=1), TINY)
    return turns, np.arccos(np.clip(cosines, 0.0, 1.0))
