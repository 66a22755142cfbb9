"""Faults of a surface: places where it suddenly bends another way than beside them, though no crease is there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete import vertex_normals
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.local_fits import LocalFits
from .problem import CGCProblem
from .roles import CREASE

__all__ = ["Fault", "fault"]

SUDDEN = 0.25  # change of the second fundamental form over one edge, against the sum at both ends, of a fault
OFTEN = 10.0  # the same, against the median: what changes as much everywhere is a coarse mesh, not a fault
APART = 3  # edges from supports and free edges, where the surface that is asked for may itself be singular
FEWEST = 4  # vertices beside each other: a few more are a point such as the middle of a monkey saddle, where it has to turn
FAR = 0.25  # length of a fault, against the size of the surface: over a saddle a shorter one spreads from every crossing of creases


class Fault(NamedTuple):
    """Where a surface changes its bending suddenly."""

    vertices: IntArray  # (k,) of all such places, none if they are too few to be seen
    worst: int  # that of the largest change, -1 without any
    change: float  # there, against the sum of the bending at both ends, at most 1


def fault(problem: CGCProblem, fits: LocalFits, edges: IntArray) -> Fault:
    """Return where the second fundamental form of a surface jumps within regions.

    Two sheets that each have the curvature asked for, such as a patchwork of saddles and domes and its mirror image, may
    meet along a line where every angle defect is as asked. Folds, fits and waves of single vertices are small there on the
    average of a large mesh; what tells such a line is how fast the bending changes, against the rest of the surface. Where
    K = 0 it may: a developable surface is bent beside a flat part.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets, without dummies.
    fits
        Of its vertices.
    edges
        ``(e, 2)`` those within regions, such as no crease is.

    Returns
    -------
    Fault
    """
    known = np.isfinite(fits.bending[:, 0]) & (problem.targets != 0.0)
    u, v = edges[known[edges].all(axis=1)].T
    if not len(u):
        return Fault(np.zeros(0, np.int64), -1, 0.0)
    size = np.sqrt(np.einsum("ij,ij->i", fits.bending[known], fits.bending[known]))
    ends = np.zeros(len(known))
    ends[known] = size
    both = np.maximum(ends[u] + ends[v], max(float(np.median(size)), np.finfo(float).tiny))
    normals = vertex_normals(problem.vertices, problem.faces)
    change = _within(fits.bending[u] - fits.bending[v], normals[u] + normals[v]) / both
    jumps = change > max(SUDDEN, OFTEN * float(np.median(change)))
    if not jumps.any():
        return Fault(np.zeros(0, np.int64), -1, 0.0)
    apart = known & _apart(problem)
    jumps &= apart[u] & apart[v]
    lines = _lines(problem.vertices, u[jumps], v[jumps])
    if not len(lines):
        return Fault(lines, -1, 0.0)
    first = int(np.argmax(np.where(jumps & np.isin(u, lines), change, -1.0)))
    return Fault(lines, int(u[first]), float(change[first]))


def _within(tensors: FloatArray, normals: FloatArray) -> FloatArray:
    """Return the norms (k,) of symmetric tensors (k, 6) within the planes across normals (k, 3) of any length."""
    squared = np.maximum(np.einsum("ij,ij->i", normals, normals), np.finfo(float).tiny)
    x, y, z = (normals / np.sqrt(squared)[:, None]).T
    xx, yy, zz, yz, zx, xy = tensors.T
    yz, zx, xy = (own / np.sqrt(2.0) for own in (yz, zx, xy))
    across = np.stack([xx * x + xy * y + zx * z, xy * x + yy * y + yz * z, zx * x + yz * y + zz * z], axis=1)
    along = across[:, 0] * x + across[:, 1] * y + across[:, 2] * z
    square = np.einsum("ij,ij->i", tensors, tensors) - 2.0 * np.einsum("ij,ij->i", across, across) + along**2
    return np.asarray(np.sqrt(np.maximum(square, 0.0)), dtype=np.float64)


def _apart(problem: CGCProblem) -> Mask:
    """Return the vertices (n,) that no support and no free edge is near to."""
    near = ~problem.asked & (problem.roles != CREASE)
    for _ in range(APART - 1):
        beside = problem.faces[near[problem.faces].any(axis=1)]
        near[beside] = True
    return ~near


def _lines(V: FloatArray, u: IntArray, v: IntArray) -> IntArray:
    """Return the vertices (k,) of edges (e,) that hang together with enough others, and reach far."""
    graph = sparse.coo_matrix((np.ones(len(u)), (u, v)), shape=(len(V), len(V)))
    part = connected_components(graph, directed=False)[1]
    order = np.argsort(part, kind="stable")
    starts = np.flatnonzero(np.diff(part[order], prepend=-1))
    reach = np.linalg.norm(np.maximum.reduceat(V[order], starts) - np.minimum.reduceat(V[order], starts), axis=1)
    long = (np.bincount(part) >= FEWEST) & (reach > FAR * np.linalg.norm(np.ptp(V, axis=0)))
    return np.flatnonzero(long[part])
