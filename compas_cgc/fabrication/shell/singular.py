"""Vertices at which the curvature of a surface with prescribed K has no bound."""

from __future__ import annotations

import numpy as np

from ...discrete import edge_faces
from ...discrete import total_mean_curvature
from ...discrete.arrays import IntArray
from ...discrete.arrays import Mask
from ...model.problem import CGCProblem

__all__ = ["between_hills_and_bowls", "singular_vertices"]


def singular_vertices(problem: CGCProblem) -> IntArray:
    """Return the supports, and the vertices of edges between hills and bowls (k,)."""
    return np.union1d(problem.supports, np.flatnonzero(between_hills_and_bowls(problem)))


def between_hills_and_bowls(problem: CGCProblem) -> Mask:
    """Return the vertices of edges between regions with K > 0 that are convex towards opposite sides (n,).

    Along such an edge the normal curvature is positive on one surface and negative on the other one. Both are tangent or fold by a small
    angle, so it nearly vanishes, as along a straight support, and the curvature across the edge, which is K over that along it, has no
    bound. A region with K < 0 amid regions with K > 0 has at least four such edges around it, unless it folds along its boundary: its
    asymptotic directions turn less often along the boundary than the boundary does.
    """
    V, F, label = problem.vertices, problem.faces, problem.regions()
    side = np.zeros(label.max(initial=-1) + 1)
    for number, K in enumerate(problem.region_targets()):
        if K is not None and K > 0.0:
            side[number] = np.sign(total_mean_curvature(V, F[label == number]))
    edges = edge_faces(F)
    inner = edges[edges[:, 3] >= 0]
    found = np.zeros(len(V), bool)
    found[inner[side[label[inner[:, 2:]]].prod(axis=1) < 0.0, :2]] = True
    return found
