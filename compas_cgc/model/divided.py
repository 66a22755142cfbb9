"""The same problem on a mesh with every face divided in four."""

from __future__ import annotations

import numpy as np

from ..discrete import edge_faces
from .problem import CGCProblem
from .roles import CREASE
from .roles import FIXED
from .roles import FREE
from .roles import INTERNAL

__all__ = ["quartered"]


def quartered(problem: CGCProblem) -> CGCProblem:
    """Return a problem with a vertex at the middle of every edge, after its own, which keep their indices.

    Parameters
    ----------
    problem
        Without dummies and laws. Goals stay those of its own vertices.
    """
    V, F, n = problem.vertices, problem.faces, len(problem.vertices)
    edges = edge_faces(F)
    ends, on_rim = edges[:, :2], edges[:, 3] < 0
    codes = np.sort(ends, axis=1) @ [n, 1]
    order = np.argsort(codes)

    def middle(pairs: np.ndarray) -> np.ndarray:
        return np.asarray(n + order[np.searchsorted(codes, np.sort(pairs, axis=1) @ [n, 1], sorter=order)])

    a, b, c = F.T
    ab, bc, ca = (middle(np.column_stack(pair)) for pair in ((a, b), (b, c), (c, a)))
    faces = np.vstack([np.column_stack(corners) for corners in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    at = middle(problem.creases)
    creases = np.vstack([np.column_stack([problem.creases[:, 0], at]), np.column_stack([at, problem.creases[:, 1]])])
    of_rim = (problem.roles[ends] == FIXED).all(axis=1)
    rim = np.zeros(n, bool)
    rim[ends[on_rim]] = True
    roles = np.where(on_rim, FREE, INTERNAL)
    roles[at - n] = CREASE
    # An edge between two supports of the rim may cross the surface.
    roles[of_rim & (on_rim | ~rim[ends].all(axis=1))] = FIXED
    known = problem.asked[ends] & np.isfinite(problem.targets[ends])
    own = np.where(known, problem.targets[ends], 0.0).sum(axis=1) / np.maximum(known.sum(axis=1), 1)
    # Beside the end of a crease the nearest vertex where K is asked for may lie beyond it, and a region may have none.
    regions, elsewhere = problem.regions(), problem.face_targets().copy()
    for region, K in enumerate(problem.region_targets()):
        within = problem.targets[problem.region_vertices(region) & problem.asked]
        if K is not None or len(within):
            elsewhere[regions == region] = within.mean() if K is None else K
    targets = np.where(known.any(axis=1), own, elsewhere[edges[:, 2]])
    return CGCProblem(
        np.vstack([V, V[ends].mean(axis=1)]),
        faces,
        np.concatenate([problem.roles, roles]),
        np.concatenate([problem.targets, targets]),
        creases=creases,
        goals=problem.goals,
    )
