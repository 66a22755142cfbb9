"""Targets that no surface can meet, told before solving."""

from __future__ import annotations

import math
from typing import NamedTuple
from typing import Optional

import numpy as np
from scipy.sparse.csgraph import connected_components

from ...discrete import _kernels
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from .system import System

__all__ = ["Overload", "overload"]

FLAT = 1e-9  # distance from its plane, against its size, of a plane curve


class Overload(NamedTuple):
    """A region that is asked for more curvature than its boundary lets a convex surface have."""

    curvature: float  # mean K̄ [1/L^2]
    area: float  # plane area under the vertices where K is asked for [L^2]


def overload(system: System) -> Optional[Overload]:
    r"""Return a region whose targets no convex surface over its boundary can meet, or None.

    The normals of a convex surface over a plane domain are all different, and their
    components across the plane add up to ``∫ K n·e dA = Σ K̄_i a_i`` with ``a_i`` the plane
    area under vertex i; over a whole hemisphere of normals they add up to π. So there
    must be ``Σ K̄_i a_i < π``. (For a disk of radius r that is ``K̄ < 1 / r²``.)

    Only regions where this holds without doubt are judged: all K̄ > 0, a disk without
    holes or creases in it, held along a plane convex curve.

    Parameters
    ----------
    system
        The problem, at its start.
    """
    V, F, pattern = system.problem.vertices, system.equations.faces, system.equations.pattern
    count, part = connected_components(pattern.matrix(np.ones(pattern.size)), directed=False)
    part_of = np.full(len(V), -1)
    part_of[system.asked] = part
    face_part = part_of[F].max(axis=1)  # asked corners of a face are neighbours, so of one part
    lowest = np.full(count, np.inf)
    np.minimum.at(lowest, part, system.targets)
    faces, rims = _grouped(np.arange(len(F)), face_part, count), _rims(system, face_part, count)
    weight = np.where(part_of >= 0, system.problem.targets, 0.0)[F].sum(axis=1) / 3
    share = (part_of >= 0)[F].sum(axis=1) / 3
    sizes = np.bincount(part, minlength=count)
    for p in np.flatnonzero(lowest > 0).tolist():
        loop = _loop(rims[p])
        euler = sizes[p] + len(rims[p]) - (3 * len(faces[p]) + len(rims[p])) / 2 + len(faces[p])
        if loop is None or euler != 1 or not _is_plane_and_convex(V[loop]):
            continue
        halves = 0.5 * _kernels.cross_vectors(V, F[faces[p]])
        across = halves.sum(axis=0)
        plane = halves @ (across / np.linalg.norm(across))
        total, area = float(weight[faces[p]] @ plane), float(share[faces[p]] @ plane)
        if total >= math.pi:
            return Overload(total / area, area)
    return None


def _grouped(items: np.ndarray, group: IntArray, count: int) -> list[np.ndarray]:
    """Return the items of each group from 0 to `count`; those of group -1 are left out."""
    order = np.argsort(group, kind="stable")
    cuts = np.searchsorted(group[order], np.arange(count + 1))
    return [items[order[a:b]] for a, b in zip(cuts[:-1], cuts[1:])]


def _rims(system: System, face_part: IntArray, count: int) -> list[IntArray]:
    """Return the boundary edges (b, 2) of each part, with the part on their left."""
    u, v, left, right = system.measures.edges.T
    padded = np.append(face_part, -1)
    here, there = face_part[left], padded[np.minimum(right, len(face_part))]
    border = np.flatnonzero(here != there)
    edges = np.vstack([np.column_stack([u, v])[border], np.column_stack([v, u])[border]])
    return _grouped(edges, np.concatenate([here[border], there[border]]), count)


def _loop(rim: IntArray) -> Optional[list[int]]:
    """Return the vertices of a rim in order, or None when it is not one simple loop."""
    following = dict(rim.tolist())
    if not len(rim) or len(following) < len(rim):
        return None
    start = int(rim[0, 0])
    loop, vertex = [start], following[start]
    while vertex != start and len(loop) < len(rim):
        loop.append(vertex)
        vertex = following.get(vertex, start)
    return loop if vertex == start and len(loop) == len(rim) else None


def _is_plane_and_convex(points: FloatArray) -> bool:
    points = points - points.mean(axis=0)
    _, spread, axes = np.linalg.svd(points, full_matrices=False)
    if spread[2] > FLAT * spread[0] or spread[1] <= FLAT * spread[0]:
        return False
    edges = (np.roll(points, -1, axis=0) - points) @ axes[:2].T
    following = np.roll(edges, -1, axis=0)
    sine = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
    turn = np.arctan2(sine, np.einsum("ij,ij->i", edges, following))
    turn *= np.sign(turn.sum())
    return bool((turn > -FLAT).all()) and abs(turn.sum() - 2 * math.pi) < 1e-6
