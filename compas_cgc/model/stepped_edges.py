"""Held edges that step up or down between two vertices, which no smooth surface follows."""

from __future__ import annotations

import numpy as np

from ..discrete import edge_faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from .problem import CGCProblem
from .roles import FIXED

__all__ = ["stepped_edges"]

TURN = np.radians(30.0)  # of a held edge at both ends of a step
ACROSS = np.radians(45.0)  # between the planes that it turns in there


def stepped_edges(problem: CGCProblem) -> list[str]:
    """Return a sentence on the steepest step of the held edges, none without any.

    Where an edge of a surface turns, the surface is tangent to the plane that it turns in. Between the two ends of a step that
    plane is another one, so that the surface folds there over a single edge of the mesh, whatever its curvature.
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
    stepped = (turns > TURN).all(axis=1) & (across > ACROSS)
    if not stepped.any():
        return []
    k = int(np.argmax(np.where(stepped, turns.min(axis=1), 0.0)))
    (_, a, b, _), (first, second) = row[k].tolist(), np.degrees(turns[k])
    names = problem.names.vertices
    digits = 2 - int(np.floor(np.log10(np.linalg.norm(np.ptp(V, axis=0)))))
    x, y = (round(number, digits) + 0.0 for number in V[a, :2].tolist())
    return [
        f"the held edge makes a step of {abs(V[b, 2] - V[a, 2]):.3g} in height from vertex {names[a]} ({x:g}, {y:g}) to the next, "
        f"{names[b]}: it turns by {first:.0f} and {second:.0f} degrees there, in planes {np.degrees(across[k]):.0f} degrees apart, and a "
        "smooth surface cannot follow; spread the step over more edges, or lead creases to both ends of it"
    ]


def _turns(V: FloatArray, row: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return the angles (k, 2) by which rows of four vertices (k, 4) turn at the inner two, and those (k,) between the planes."""
    sides = np.diff(V[row], axis=1)
    crosses = np.cross(sides[:, :-1], sides[:, 1:])
    sines = np.linalg.norm(crosses, axis=2)
    turns = np.arctan2(sines, np.einsum("kij,kij->ki", sides[:, :-1], sides[:, 1:]))
    cosines = np.abs(np.einsum("ki,ki->k", crosses[:, 0], crosses[:, 1])) / np.maximum(sines.prod(axis=1), np.finfo(float).tiny)
    return turns, np.arccos(np.clip(cosines, 0.0, 1.0))
