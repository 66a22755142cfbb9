"""Panels that are images of each other in a symmetric design, which get the same mould."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..discrete.arrays import Mask
from ..meshing.regions import inner_labels
from .panelling import Panelling

__all__ = ["symmetric_panels"]

EXACT = 1e-6  # of the size, within which the image of a vertex is a vertex


def symmetric_panels(panelling: Panelling, fixed: Mask) -> IntArray:
    """Return the number of the group of panels that each belongs to (p,): its images in mirrors of the design and of what is held (n,).

    Upright mirrors through the middle are tried: along the axes of the drawing, at 45 degrees to them, and along the principal axes of
    the plan. The layout of the triangles within panels does not count.
    """
    V = panelling.vertices
    arms = V - V[np.unique(panelling.faces)].mean(axis=0)
    size = float(np.linalg.norm(arms, axis=1).max())
    own = inner_labels(len(V), panelling.faces, panelling.panels)
    inside = np.flatnonzero(own >= 0)
    tree = cKDTree(arms)
    pairs = [np.empty((0, 2), np.int64)]
    for normal in _normals(arms):
        away, to = tree.query(arms - 2.0 * np.outer(arms @ normal, normal))
        if away.max() <= EXACT * size and np.array_equal(fixed[to], fixed) and (own[to[inside]] >= 0).all():
            pairs.append(np.column_stack([own[inside], own[to[inside]]]))
    joined = np.concatenate(pairs)
    count = panelling.panel_count
    graph = sparse.csr_matrix((np.ones(len(joined)), joined.T), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _normals(arms: FloatArray) -> list[FloatArray]:
    """Return the normals (3,) of mirrors that may take points (n, 3) to each other."""
    plan = arms[:, :2]
    own = np.linalg.eigh(plan.T @ plan)[1].T
    angles = [0.0, 0.25 * np.pi, 0.5 * np.pi, 0.75 * np.pi, *(np.arctan2(y, x) for x, y in own)]
    return [np.array([np.cos(angle), np.sin(angle), 0.0]) for angle in angles]
