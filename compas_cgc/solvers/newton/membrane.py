"""Harmonic membrane and Tutte embedding: a plain start in place of one that leads nowhere."""

from __future__ import annotations

import numpy as np

from ...discrete import _kernels
from ...discrete.arrays import TINY
from ...discrete.arrays import FloatArray
from ...discrete.laplacian import cotangent_stiffness
from ...discrete.sparsity import RingPattern
from .system import System

__all__ = ["membrane"]


def membrane(system: System) -> FloatArray:
    """Return the vertices (n, 3) of a taut surface through all that is held.

    Where the start is a graph over a plane, each vertex keeps its place in plan and takes
    a harmonic height. Where it is not (overhanging, folded, noisy beyond that), each
    vertex goes to the mean of its neighbours, which over a convex plane boundary lays
    any mesh out without folds.

    Raises
    ------
    SingularMatrixError
        If a part of the mesh is held nowhere.

    References
    ----------
    Tutte, doi:10.1112/plms/s3-13.1.743.
    """
    vertices, faces = system.problem.vertices, system.problem.faces
    halves = _kernels.cross_vectors(vertices, faces)
    across = halves.sum(axis=0)
    up = across / max(float(np.linalg.norm(across)), TINY)
    pattern = RingPattern(faces, len(vertices), system.asked, np.arange(len(vertices)))
    if (halves @ up > 0).all():
        heights = vertices @ up
        plan = vertices - heights[:, None] * up
        level = _harmonic(system, cotangent_stiffness(plan, pattern).data, pattern, heights[:, None])
        return plan + level * up
    ring = np.diff(pattern.indptr)
    weights = np.where(pattern.indices == np.repeat(system.asked, ring), np.repeat(ring - 1.0, ring), -1.0)
    return _harmonic(system, weights, pattern, vertices)


def _harmonic(system: System, weights: FloatArray, pattern: RingPattern, values: FloatArray) -> FloatArray:
    """Return the values (n, d) with those at the unknowns balanced by the weights of a Laplacian."""
    rows = pattern.matrix(weights)
    held = values.copy()
    held[system.asked] = 0.0
    inner = system.equations.pattern.matrix(np.ones(system.equations.pattern.size))
    inner.data = np.asarray(rows[:, system.asked].data)
    held[system.asked] = system.solver.factorise(inner).solve(-(rows @ held))
    return held
