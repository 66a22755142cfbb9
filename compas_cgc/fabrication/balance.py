"""Edge forces in equilibrium with a load."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from ..discrete import face_areas
from ..discrete.arrays import Edges
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Mask
from ..discrete.arrays import Vectors
from ..discrete.arrays import Vertices
from ..linalg import factorise

__all__ = ["in_balance", "mean_size", "pull_of"]

REGULARISATION = 1e-13  # relative to the diagonal, for bars without force


def pull_of(V: Vertices, bars: Edges, forces: FloatArray) -> Vectors:
    """Return the sum of edge forces at every vertex (n, 3) [F]."""
    u, v = bars[:, 0], bars[:, 1]
    along = V[v] - V[u]
    each = forces[:, None] * along / np.linalg.norm(along, axis=1, keepdims=True)
    total = np.zeros((len(V), 3))
    np.add.at(total, u, each)
    np.subtract.at(total, v, each)
    return total


def mean_size(load: Vectors) -> float:
    """Return the mean load of a vertex, the reference for residuals [F]."""
    return float(np.linalg.norm(load, axis=1).mean())


def in_balance(V: Vertices, F: Faces, bars: Edges, start: FloatArray, load: Vectors, balanced: Mask) -> tuple[FloatArray, Vectors, float]:
    """Return the equilibrium edge forces nearest to the initial ones, the initial residual (n, 3), and the largest relative residual.

    Nearest means the least sum of squared stresses, as in an elastic membrane.
    """
    A = _equilibrium(V, bars, balanced)
    wanted = load[balanced].ravel()
    forces = start.copy()
    before = np.zeros_like(load)
    before[balanced] = (A @ forces + wanted).reshape(-1, 3)
    if not len(wanted):
        return forces, before, 0.0
    correct = _by_strips(V, F, bars, balanced, A) if start.any() else _by_stresses(V, F, bars, A)
    size = mean_size(load)
    rest = np.inf
    for _ in range(20):
        missing = A @ forces + wanted
        largest = float(np.abs(missing).max()) / size
        if largest < 1e-14 or largest > 0.5 * rest:
            break
        rest = largest
        forces = forces - correct(missing)
    rest = float(np.linalg.norm((A @ forces + wanted).reshape(-1, 3), axis=1).max()) / size
    return forces, before, rest


def _equilibrium(V: Vertices, bars: Edges, balanced: Mask) -> sparse.csr_matrix:
    """Return the equilibrium matrix (3 k, b): from edge forces to the resultants at the balanced vertices."""
    u, v = bars[:, 0], bars[:, 1]
    along = V[v] - V[u]
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    row = np.full(len(V), -1)
    row[balanced] = np.arange(balanced.sum())
    entries = []
    for node, sign in ((u, 1.0), (v, -1.0)):
        kept = np.flatnonzero(row[node] >= 0)
        for axis in range(3):
            entries.append((3 * row[node[kept]] + axis, kept, sign * along[kept, axis]))
    rows, columns, values = (np.concatenate(part) for part in zip(*entries))
    return sparse.csr_matrix((values, (rows, columns)), shape=(3 * int(balanced.sum()), len(bars)))


def _by_strips(V: Vertices, F: Faces, bars: Edges, balanced: Mask, A: sparse.csr_matrix) -> Callable[[FloatArray], FloatArray]:
    """Return a solver for the smallest edge forces with given resultants, each edge weighted as a strip of the surface."""
    areas = np.r_[face_areas(V, F), 0.0]
    length = np.linalg.norm(V[bars[:, 1]] - V[bars[:, 0]], axis=1)
    strip = (areas[bars[:, 2]] + areas[bars[:, 3]]) / length**2
    M = A @ sparse.diags(strip) @ A.T
    lifted = (M + REGULARISATION * float(M.diagonal().mean()) * sparse.identity(M.shape[0])).tocsr()
    factor = factorise(lifted, symmetric=True, points=np.repeat(V[balanced], 3, axis=0), refine=False)
    return lambda missing: strip * (A.T @ factor.solve(missing))


def _by_stresses(V: Vertices, F: Faces, bars: Edges, A: sparse.csr_matrix) -> Callable[[FloatArray], FloatArray]:
    """Return a solver for the edge forces of least squared stress with given resultants."""
    areas = face_areas(V, F)
    vector = V[bars[:, 1]] - V[bars[:, 0]]
    length = np.linalg.norm(vector, axis=1)
    share = np.where(bars[:, 3] >= 0, 0.5, 1.0)
    entries = []
    for side in (2, 3):
        kept = np.flatnonzero(bars[:, side] >= 0)
        face = bars[kept, side]
        dyad = (vector[kept, :, None] * vector[kept, None, :]).reshape(-1, 9)
        weight = share[kept] / length[kept] / np.sqrt(areas[face])
        entries.append((9 * face[:, None] + np.arange(9), np.repeat(kept[:, None], 9, axis=1), weight[:, None] * dyad))
    rows, columns, values = (np.concatenate([part.ravel() for part in parts]) for parts in zip(*entries))
    G = sparse.csr_matrix((values, (rows, columns)), shape=(9 * len(F), len(bars)))
    W = G.T @ G
    W = W / float(W.diagonal().mean())
    system = sparse.bmat([[W, A.T], [A, -REGULARISATION * sparse.identity(A.shape[0])]], format="csc")
    factor = splu(system)
    return lambda missing: factor.solve(np.r_[np.zeros(A.shape[1]), missing])[: A.shape[1]]
