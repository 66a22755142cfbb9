"""The same problem on a mesh with shorter edges, all of them or those along its rim and creases."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..discrete import edge_faces
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..meshing.halving import halved_faces
from ..meshing.halving import middles
from .problem import CGCProblem
from .roles import CREASE
from .roles import FIXED
from .roles import FREE
from .roles import INTERNAL

__all__ = ["along_inner_lines", "line_edges", "with_halved_edges", "with_short_lines"]


def line_edges(problem: CGCProblem) -> IntArray:
    """Return the edges (c, 2) along the rim, creases and lines of supports, each from its smaller vertex to its larger one."""
    edges = edge_faces(problem.faces)
    return np.asarray(np.sort(edges[:, :2], axis=1)[(edges[:, 3] < 0) | along_inner_lines(problem, problem.roles == FIXED, edges)])


def along_inner_lines(problem: CGCProblem, fixed: Mask, edges: IntArray) -> Mask:
    """Return which of all edges with their faces (e, 4) lie inside along creases, lines of fixed vertices (n,) or borders of held faces."""
    n, ends, inner = len(problem.vertices), edges[:, :2], edges[:, 3] >= 0
    rim = np.zeros(n, bool)
    rim[ends[~inner]] = True
    on_crease = np.isin(np.sort(ends, axis=1) @ [n, 1], np.sort(problem.creases, axis=1) @ [n, 1])
    creased = problem.roles == CREASE
    # Some problems name the vertices of creases, but not their edges.
    alone = creased.copy()
    alone[problem.creases] = False
    # An edge between two supports of the rim may cross the surface.
    whole = np.asarray(fixed[problem.faces].all(axis=1))
    held = fixed[ends].all(axis=1) & ~rim[ends].all(axis=1) & ~whole[edges[:, 2:]].all(axis=1)
    return np.asarray(inner & (on_crease | (creased[ends].all(axis=1) & alone[ends].any(axis=1)) | held))


def with_short_lines(problem: CGCProblem, longest: float) -> CGCProblem:
    """Halve the edges along the rim, creases and lines of supports until none is longer than a given length.

    Vertices and regions keep their numbers, and goals refer to the same vertices.

    Parameters
    ----------
    problem
        Problem without dummies and laws.
    longest
        Largest length of these edges [L].
    """
    while True:
        edges = line_edges(problem)
        u, v = edges.T
        long = np.linalg.norm(problem.vertices[v] - problem.vertices[u], axis=1) > longest
        if not long.any():
            return problem
        problem = _halved(problem, edges[long])


def with_halved_edges(problem: CGCProblem) -> CGCProblem:
    """Halve all edges, so that each face becomes four.

    Vertices and regions keep their numbers, and goals refer to the same vertices.

    Parameters
    ----------
    problem
        Problem without dummies and laws.
    """
    n, edges = len(problem.vertices), np.sort(edge_faces(problem.faces)[:, :2], axis=1)
    fine = _halved(problem, edges)
    along = np.isin(edges @ [n, 1], line_edges(problem) @ [n, 1])
    return replace(fine, roles=np.concatenate([problem.roles, np.where(along, fine.roles[n:], INTERNAL)]))


def _halved(problem: CGCProblem, edges: IntArray) -> CGCProblem:
    """Return a problem with vertices at the middles of edges (e, 2), each from its smaller vertex to its larger one."""
    V, n = problem.vertices, len(problem.vertices)
    between = middles(problem.creases, edges, n)
    halved = between >= 0
    at, (start, end) = between[halved], problem.creases[halved].T
    creases = np.vstack([problem.creases[~halved], np.column_stack([start, at]), np.column_stack([at, end])])
    roles = np.full(len(edges), FREE)
    roles[at - n] = CREASE
    roles[(problem.roles[edges] == FIXED).all(axis=1)] = FIXED
    # A vertex of a crease belongs to several regions, so that the target is that of the other end, or of the region beside.
    counted = problem.roles[edges] != CREASE
    targets = np.where(counted, problem.targets[edges], 0.0).sum(axis=1) / np.maximum(counted.sum(axis=1), 1)
    both = ~counted.any(axis=1)
    beside = edge_faces(problem.faces)
    faces = beside[middles(edges[both], beside[:, :2], 0), 2]
    targets[both] = np.array(problem.region_targets(), dtype=np.float64)[problem.regions()[faces]]
    return CGCProblem(
        np.vstack([V, V[edges].mean(axis=1)]),
        halved_faces(problem.faces, edges, n, V),
        np.concatenate([problem.roles, roles]),
        np.concatenate([problem.targets, targets]),
        creases=creases,
        goals=problem.goals,
    )
