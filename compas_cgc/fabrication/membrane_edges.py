"""Edges of a membrane: those inside regions, which carry its forces, and those around regions, which carry line loads."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..discrete import edge_faces
from ..discrete import face_normals
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Vectors
from ..discrete.arrays import Vertices
from ..model.problem import CGCProblem
from ..model.roles import FIXED
from .layout import among

__all__ = ["EdgeLoads", "edges_of_regions", "fold_angles", "line_loads", "rim_edges"]


class EdgeLoads(NamedTuple):
    """Line loads of regions on their boundaries."""

    edges: Edges  # (e, 2) edges along boundaries and creases
    kind: IntArray  # (e,) 0 support, 1 crease, 2 free edge
    load: Vectors  # (e, 3) force of the surface on the line per length [F/L]


def edges_of_regions(problem: CGCProblem) -> tuple[Edges, EdgeLoads]:
    """Return the edges inside regions with their faces (b, 4), and the edges around regions."""
    V, F = problem.vertices, problem.faces
    edges = edge_faces(F)
    around = (edges[:, 3] < 0) | among(edges[:, :2], problem.creases, len(V))
    rim = edges[around]
    fixed = problem.roles == FIXED
    held = fixed[rim[:, :2]].all(axis=1)
    kind = np.where(held, 0, np.where(rim[:, 3] >= 0, 1, 2))
    return edges[~around], EdgeLoads(rim[:, :2], kind, np.zeros((len(rim), 3)))


def rim_edges(F: Faces, rim: Edges) -> Edges:
    """Return edges on the rim with their faces (e, 4)."""
    edges = edge_faces(F)
    return edges[among(edges[:, :2], rim, int(F.max()) + 1)]


def fold_angles(V: Vertices, F: Faces, bars: Edges) -> FloatArray:
    """Return the fold angles of edges, positive where convex (b,) [rad]."""
    u, v, left, right = bars.T
    normals = face_normals(V, F)
    along = V[v] - V[u]
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    sine = np.einsum("ij,ij->i", np.cross(normals[left], normals[right]), along)
    return np.arctan2(sine, np.einsum("ij,ij->i", normals[left], normals[right]))


def line_loads(V: Vertices, F: Faces, on: EdgeLoads, corners: FloatArray) -> EdgeLoads:
    """Return the line loads on the boundaries of regions: -N nu, summed over both sides of a crease."""
    edges = edge_faces(F)
    edges = edges[among(edges[:, :2], on.edges, len(V))]
    normals = face_normals(V, F)
    along = V[edges[:, 1]] - V[edges[:, 0]]
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    load = np.zeros((len(edges), 3))
    for side, sign in ((2, 1.0), (3, -1.0)):
        face = edges[:, side]
        outward = sign * np.cross(along, normals[face])
        ends = [corners[face, np.argmax(F[face] == edges[:, k, None], axis=1)] for k in (0, 1)]
        load += np.where((face >= 0)[:, None], -np.einsum("eij,ej->ei", 0.5 * (ends[0] + ends[1]), outward), 0.0)
    return EdgeLoads(edges[:, :2], on.kind, load)
