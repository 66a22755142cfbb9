"""Faults of a surface: lines without a crease across which the bending jumps."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..discrete import vertex_normals
from ..discrete.arrays import TINY
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..discrete.local_fits import LocalFits
from ..discrete.topology import within_rings
from .problem import CGCProblem
from .roles import CREASE

__all__ = ["Fault", "fault"]

# change of the second fundamental form over one edge relative to the sum at both ends, that is a jump; a mirrored surface changes by 1
JUMP = 0.25
JUMP_OVER_MEDIAN = 10.0  # the same relative to the median change; on a coarse mesh all changes are large
EDGES_FROM_RIM = 3  # distance from supports and free edges [edges]; nearer to them the exact surface may be singular
MIN_VERTICES = 4  # connected vertices of a fault; fewer are a point such as the centre of a monkey saddle, where the bending has to turn
MIN_REACH = 0.25  # extent of a fault relative to the surface; on saddles shorter ones start at every crossing of creases


class Fault(NamedTuple):
    """Vertices where the bending of a surface jumps."""

    vertices: IntArray  # (k,) all of them, empty if they are too few to be visible
    worst: int  # vertex with the largest change, -1 if there is none
    change: float  # change there relative to the sum of the bending at both ends, at most 1


def fault(problem: CGCProblem, fits: LocalFits, edges: IntArray) -> Fault:
    """Return the vertices where the second fundamental form jumps within a region.

    Two sheets that each meet their targets, such as a patchwork and its mirror image, may join along a line at which every angle
    defect also meets its target. Averages over a large mesh hide such a line; the change of bending over single edges,
    compared with the rest of the surface, shows it. Vertices with K̄ = 0 are left out: a developable surface may be bent
    beside a flat part.

    Parameters
    ----------
    problem
        Vertices, faces, roles and targets, without dummies.
    fits
        Local fits at its vertices.
    edges
        ``(e, 2)`` edges within regions, without creases.

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
    both = np.maximum(ends[u] + ends[v], max(float(np.median(size)), TINY))
    normals = vertex_normals(problem.vertices, problem.faces)
    change = _within(fits.bending[u] - fits.bending[v], normals[u] + normals[v]) / both
    jumps = change > max(JUMP, JUMP_OVER_MEDIAN * float(np.median(change)))
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
    """Return the norms (k,) of symmetric tensors (k, 6) restricted to the planes normal to vectors (k, 3)."""
    squared = np.maximum(np.einsum("ij,ij->i", normals, normals), TINY)
    x, y, z = (normals / np.sqrt(squared)[:, None]).T
    xx, yy, zz, yz, zx, xy = tensors.T
    yz, zx, xy = (own / np.sqrt(2.0) for own in (yz, zx, xy))
    across = np.stack([xx * x + xy * y + zx * z, xy * x + yy * y + yz * z, zx * x + yz * y + zz * z], axis=1)
    along = across[:, 0] * x + across[:, 1] * y + across[:, 2] * z
    square = np.einsum("ij,ij->i", tensors, tensors) - 2.0 * np.einsum("ij,ij->i", across, across) + along**2
    return np.asarray(np.sqrt(np.maximum(square, 0.0)), dtype=np.float64)


def _apart(problem: CGCProblem) -> Mask:
    """Return the vertices at least EDGES_FROM_RIM edges from supports and free edges (n,)."""
    return ~within_rings(problem.faces, ~problem.asked & (problem.roles != CREASE), EDGES_FROM_RIM - 1)


def _lines(V: FloatArray, u: IntArray, v: IntArray) -> IntArray:
    """Return the vertices (k,) of connected groups of edges (e,) with enough vertices and a sufficient extent."""
    graph = sparse.coo_matrix((np.ones(len(u)), (u, v)), shape=(len(V), len(V)))
    part = connected_components(graph, directed=False)[1]
    order = np.argsort(part, kind="stable")
    starts = np.flatnonzero(np.diff(part[order], prepend=-1))
    reach = np.linalg.norm(np.maximum.reduceat(V[order], starts) - np.minimum.reduceat(V[order], starts), axis=1)
    long = (np.bincount(part) >= MIN_VERTICES) & (reach > MIN_REACH * np.linalg.norm(np.ptp(V, axis=0)))
    return np.flatnonzero(long[part])
