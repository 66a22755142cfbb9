"""Membrane stress at the corners of faces, by formula or from edge forces."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete import face_areas
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Vectors
from ..discrete.arrays import Vertices
from ..errors import CGCError
from ..model.problem import CGCProblem
from .shape_operators import principal_curvatures
from .shape_operators import shape_operators

__all__ = ["principal_forces", "stress_by_formula", "stress_of_bars"]


def stress_by_formula(problem: CGCProblem, label: IntArray, curvature: FloatArray, pressure: float) -> FloatArray:
    """Return N = p / (2 K) cof S at the corners of every face, with shape operators fitted by region (m, 3, 3, 3) [F/L]."""
    V, F = problem.vertices, problem.faces
    corners = np.zeros((len(F), 3, 3, 3))
    for region, K in enumerate(curvature.tolist()):
        own = np.flatnonzero(label == region)
        S, normals = shape_operators(V, F[own])
        if not np.isfinite(S[F[own]]).all():
            raise CGCError(f"region {region} has too few faces to compute curvatures; refine its mesh")
        trace = np.trace(S, axis1=1, axis2=2)
        cofactor = trace[:, None, None] * (np.eye(3) - normals[:, :, None] * normals[:, None, :]) - S
        corners[own] = pressure / (2.0 * K) * cofactor[F[own]]
    return corners


def stress_of_bars(V: Vertices, F: Faces, bars: Edges, forces: FloatArray) -> FloatArray:
    """Return the stress equivalent to edge forces at the corners of every face (m, 3, 3, 3) [F/L].

    Edge forces are distributed to faces and averaged over the rings of vertices within a region.
    """
    u, v, left, right = bars.T
    vector = V[v] - V[u]
    length = np.linalg.norm(vector, axis=1)
    # Boundary edges belong to one face.
    share = np.where(right >= 0, 0.5, 1.0)
    each = (share * forces / length)[:, None, None] * vector[:, :, None] * vector[:, None, :]
    sums = np.zeros((len(F), 3, 3))
    np.add.at(sums, left, each)
    np.add.at(sums, right[right >= 0], each[right >= 0])
    areas = face_areas(V, F)
    label = _regions_of(F, bars)
    corner = np.unique(np.column_stack([np.repeat(label, 3), F.ravel()]), axis=0, return_inverse=True)[1].reshape(-1, 3)
    count = int(corner.max()) + 1
    at_vertex, area = np.zeros((count, 3, 3)), np.zeros(count)
    for k in range(3):
        np.add.at(at_vertex, corner[:, k], sums)
        np.add.at(area, corner[:, k], areas)
    return (at_vertex / area[:, None, None])[corner]


def _regions_of(F: Faces, bars: Edges) -> IntArray:
    inside = bars[bars[:, 3] >= 0]
    graph = sparse.coo_matrix((np.ones(len(inside), np.int8), (inside[:, 2], inside[:, 3])), shape=(len(F), len(F)))
    return connected_components(graph, directed=False)[1].astype(np.int64)


def principal_forces(corners: FloatArray, normals: Vectors) -> tuple[FloatArray, FloatArray]:
    """Return the principal forces N1 and N2 (m, 2) [F/L] and their directions (m, 2, 3), from corner means in the planes of faces."""
    plane = np.eye(3) - normals[:, :, None] * normals[:, None, :]
    found = principal_curvatures(plane @ corners.mean(axis=1) @ plane, normals)
    return np.column_stack([found.larger, found.smaller]), np.stack([found.larger_direction, found.smaller_direction], axis=1)
