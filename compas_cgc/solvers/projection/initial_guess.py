"""A start for regions that are flat, where K does not change with a small move."""

from __future__ import annotations

import math
from typing import Callable

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ...discrete import boundary_vertices
from ...discrete import face_normals
from ...discrete import vertex_normals
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...linalg import factorise

__all__ = ["flat_share", "flat_vertices", "seeded"]

FLAT = 0.01  # fold against the one that the target would have
SAME = 1e-9  # distances closer than this count as one
PROBE = 1e-3  # height at which a seed's curvature is measured, against the size


def flat_vertices(vertices: FloatArray, faces: IntArray, wanted: FloatArray) -> NDArray[np.bool_]:
    """Mark the vertices that are flat for the curvature ``K̄_i A_i`` (n,) wanted of them."""
    normals, mean = face_normals(vertices, faces), vertex_normals(vertices, faces)
    corner = faces.ravel()
    fold = np.zeros(len(vertices))
    np.maximum.at(fold, corner, np.linalg.norm(np.repeat(normals, 3, axis=0) - mean[corner], axis=1))
    return fold < FLAT * np.sqrt(np.abs(wanted))


def flat_share(vertices: FloatArray, faces: IntArray, wanted: FloatArray) -> float:
    """Return the part of the curvature ``K̄_i A_i`` (n,) wanted that is wanted of flat vertices."""
    total = float(np.abs(wanted).sum())
    return float(np.abs(wanted[flat_vertices(vertices, faces, wanted)]).sum()) / total if total > 0.0 else 0.0


def seeded(
    vertices: FloatArray,
    faces: IntArray,
    movable: IntArray,
    stiffness: sparse.csr_matrix,
    wanted: FloatArray,
    defects: Callable[[FloatArray], FloatArray],
    highest: float,
) -> FloatArray:
    """Return the shape on a low dome or saddle over its supports.

    The dome is a paraboloid, the saddle a quadric, less what a plate would be that passes
    through its values at the supports. Where the whole boundary is fixed the square root of
    that is tried as well, which meets it steeply, like an ellipsoid.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    movable
        ``(c,)`` vertices that may move.
    stiffness
        ``(n, n)`` metric of one coordinate.
    wanted
        ``(n,)`` angle defects to come near to where the shape is flat, zero elsewhere [rad].
    defects
        Angle defects (n,) of a shape (n, 3), zero where none are asked for.
    highest
        Highest rise over an open boundary, as a part of the mesh's diameter.
    """
    dome = bool((wanted > 0).any())
    shape = _quadric(vertices, faces, movable, stiffness, dome)
    closed = not boundary_vertices(vertices, faces)[movable].any()
    corners = vertices[np.unique(faces)]
    size = 2 * float(np.linalg.norm(corners - corners.mean(axis=0), axis=1).max())
    normals = vertex_normals(vertices, faces)
    asked = wanted != 0.0
    seeds, misfits = [], []
    for form in (shape, np.sqrt(np.maximum(shape, 0.0))) if dome and closed else (shape,):
        if not form.any():
            continue
        rise = (size / np.abs(form).max() * form)[:, None] * normals
        # Defects grow with the square of the height. The steep rim of a closed dome would drown in squares.
        brought = np.where(asked, defects(vertices + PROBE * rise), 0.0) / PROBE**2
        if not brought.any():
            continue
        if closed:
            height = min(1.0, math.sqrt(np.abs(wanted).sum() / np.abs(brought).sum()))
        else:
            height = min(highest, math.sqrt(abs(wanted @ brought) / (brought @ brought)))
        seeds.append(vertices + height * rise)
        misfits.append(float(np.abs(np.where(asked, defects(seeds[-1]), 0.0) - wanted).sum()))
    return seeds[int(np.argmin(misfits))] if seeds else vertices


def _quadric(vertices: FloatArray, faces: IntArray, movable: IntArray, stiffness: sparse.csr_matrix, dome: bool) -> FloatArray:
    used = np.unique(faces)
    fixed = np.setdiff1d(used, movable)
    arm = vertices - vertices[used].mean(axis=0)
    square = np.einsum("ij,ij->i", arm, arm)
    shape = -square
    if not dome:
        # The first of the farthest vertices: an axis that turns with the model.
        far = used[np.flatnonzero(square[used] >= (1 - SAME) * square[used].max())[0]]
        shape = 2 * (arm @ arm[far]) ** 2 / square[far] - square
    if len(fixed):
        shape = shape - shape[fixed].mean()
        rows = stiffness[movable]
        solver = factorise(rows[:, movable], symmetric=True, points=vertices[movable], refine=False)
        shape[movable] += solver.solve(rows[:, fixed] @ shape[fixed])
    result = np.zeros(len(vertices))
    result[movable] = shape[movable]
    return result
