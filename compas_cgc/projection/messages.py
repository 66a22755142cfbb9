"""One sentence on how a projection ended."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete.arrays import FloatArray
from .system import Point
from .system import System

__all__ = ["enclosed_negative", "message"]

ON = 1e-6  # distance from a constraint, in the local frame, that is as good as none


def message(status: str, step: int, point: Point, start: Point, goal: float, scale2: float, system: System, targets: FloatArray) -> str:
    """Return the sentence for a status; ``scale2`` turns model curvatures into local ones."""
    reached = f"largest |K - K̄| {point.max_error / scale2:.3g}"
    if status == "converged":
        return f"converged in {step} steps: {reached}"
    if status == "cancelled":
        return f"cancelled after {step} steps: {reached}"
    if point.max_error > start.max_error:
        reached += f", more than the {start.max_error / scale2:.3g} of the start"
    if status == "step_limit":
        return f"not converged in {step} steps: {reached}, asked for {goal / scale2:.3g}; allow more steps, or a smaller smoothness"
    return f"stalled: {_cause(point, system, targets)}; the best shape is returned, {reached}"


def _cause(point: Point, system: System, targets: FloatArray) -> str:
    vertex = int(np.argmax(point.gap))
    if point.gap[vertex] > ON:
        return f"vertex {vertex} cannot fulfil its constraints; take one of them away"
    if not len(system.columns):
        return "no vertex may move; free some"
    if enclosed_negative(system, targets):
        return "a region of negative K needs some free edge"
    return "the supports may not allow this curvature; free an edge or a crease, or choose a K̄ nearer to that of the start"


def enclosed_negative(system: System, targets: FloatArray) -> bool:
    """Return whether a region of negative K̄ has fixed vertices all around it."""
    F, n = system.faces, len(targets)
    asked = np.zeros(n, bool)
    asked[system.rows] = True
    u, v = F.ravel(), np.roll(F, -1, axis=1).ravel()
    inside = asked[u] & asked[v]
    joined = sparse.csr_matrix((np.ones(np.count_nonzero(inside)), (u[inside], v[inside])), shape=(n, n))
    _, region = connected_components(joined, directed=False)
    loose = np.zeros(n, bool)
    loose[system.columns] = True
    loose &= ~asked
    touched = np.zeros(n, bool)
    for a, b in ((u, v), (v, u)):
        touched[region[a[asked[a] & loose[b]]]] = True
    negative = system.rows[targets[system.rows] < 0]
    return bool((~touched[region[negative]]).any())
