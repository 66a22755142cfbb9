"""Axes of the nodes of plane quads, along which faces are offset and beams lie."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...discrete.arrays import Vectors
from ...linalg import factorise
from .planarity import polygon_edges

__all__ = ["node_axes", "polygon_normal"]

AXIS_RANK = 5e-3  # relative size of singular values below which normals around a corner count as dependent: faces within half a degree
AXIS_STEPS = 10  # of the axes of corners at the rim towards plane beams
AXIS_DAMPING = 1e-3  # weight of changes of axes against twists, which keeps axes of nearly straight rims from leaning


def polygon_normal(points: Vectors) -> FloatArray:
    """Return the unit normal (3,) of a plane polygon."""
    normal = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    return np.asarray(normal / np.linalg.norm(normal))


def node_axes(points: Vectors, faces: list[list[int]]) -> Vectors:
    """Return the vectors (k, 3) that move corners by one along the normals of all faces around them, by least squares.

    Corners at the rim have one face or two, which leave freedom to their axes. It is used so that beams from and along the rim are plane.
    """
    around: list[list[FloatArray]] = [[] for _ in points]
    for face in faces:
        normal = polygon_normal(points[face])
        for vertex in face:
            around[vertex].append(normal)
    axes = np.array([np.linalg.lstsq(np.array(own), np.ones(len(own)), rcond=AXIS_RANK)[0] for own in around], dtype=np.float64)
    free = [_kernel(np.array(own)) for own in around]
    owner = np.repeat(np.arange(len(points)), [len(own) for own in free])
    ways = np.vstack(free)
    edges = polygon_edges(faces)
    rim = edges[np.isin(edges, owner).any(axis=1)]
    along = points[rim[:, 1]] - points[rim[:, 0]]
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    # Edges and the ways to move the axes of their starts and ends.
    pairs = [(_incidence(rim[:, side], len(points)) @ _incidence(owner, len(points)).T).nonzero() for side in (0, 1)]
    for _ in range(AXIS_STEPS):
        start, end = axes[rim[:, 0]], axes[rim[:, 1]]
        twist = np.einsum("ei,ei->e", along, np.cross(start, end))
        slopes = [np.cross(end, along), np.cross(along, start)]
        J = sparse.csr_matrix(
            (np.concatenate([np.einsum("pi,pi->p", slope[e], ways[w]) for slope, (e, w) in zip(slopes, pairs)]), np.hstack(pairs)),
            shape=(len(rim), len(owner)),
        )
        damped = J.T @ J + AXIS_DAMPING**2 * sparse.identity(len(owner))
        move = factorise(damped.tocsr(), symmetric=True).solve(-(J.T @ twist))
        np.add.at(axes, owner, move[:, None] * ways)
    return axes


def _kernel(normals: FloatArray) -> FloatArray:
    """Return unit vectors (j, 3) perpendicular to some normals (k, 3) and to each other."""
    _, values, rows = np.linalg.svd(normals, full_matrices=True)
    return np.asarray(rows[int((values > AXIS_RANK * values[0]).sum()) :])


def _incidence(corners: IntArray, count: int) -> sparse.csr_matrix:
    """Return a matrix (r, count) with a one at the corner of every row."""
    return sparse.csr_matrix((np.ones(len(corners)), corners, np.arange(len(corners) + 1)), shape=(len(corners), count))
