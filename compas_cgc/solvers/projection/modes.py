"""The gentlest ways to bend a surface towards the curvature that it lacks."""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import LinearOperator
from scipy.sparse.linalg import eigsh

from ...discrete import vertex_normals
from ...discrete.arrays import FloatArray
from ...discrete.jacobian import CurvatureEquations
from ...discrete.laplacian import cotangent_laplacian
from .system import System

__all__ = ["bending_modes", "is_bulge"]

FEWEST = 8  # vertices that may move, for which there is a choice of modes
ROUGH = 1e-3  # relative error of an eigenvalue
ROUNDS = 60  # of the Lanczos method
CLEAR = 0.3  # sum of what a mode is bent, against that of its absolute values, that says which side it bulges to
MEAN = 0.3  # of a mode, against its mean square, from which it is a bulge
TINY = 1e-300  # bending that is none
SPREAD = 1.7  # step of the first vector's phase: some of every mode


def bending_modes(
    system: System, equations: CurvatureEquations, vertices: FloatArray, lacking: FloatArray, count: int = 2
) -> list[FloatArray]:
    """Return moves along the normals that bring the most curvature, where it is lacking, for their bending energy.

    Where a surface is flat, or its curvature does not change with a small move, the defects change with the square of
    a move. That square, signed by what is lacking, against the bending energy makes an eigenvalue problem. Over corner
    supports its first vectors are the dome or the saddles through them, as symmetric as the supports are.

    Parameters
    ----------
    system, equations
        The problem.
    vertices
        ``(n, 3)`` the shape to be bent.
    lacking
        ``(k,)`` angle defects wanted less those of the shape; their signs count.
    count
        How many.

    Returns
    -------
    list of (n, 3) float64
        Moves whose longest is one, the most effective first; none that bring nothing.
    """
    signs = np.where(lacking >= 0.0, 1.0, -1.0)
    key = vertices.tobytes() + signs.tobytes() + bytes([count])
    if key not in system.modes:
        system.modes[key] = _bending_modes(system, equations, vertices, signs, count)
    return system.modes[key]


def _bending_modes(system: System, equations: CurvatureEquations, vertices: FloatArray, signs: FloatArray, count: int) -> list[FloatArray]:
    columns, size = system.columns, len(system.columns)
    if size < FEWEST:
        return []
    normals = vertex_normals(vertices, system.faces)[columns]
    stiffness, solve = system.fairness.along_normals()

    hessian = equations.hessian(vertices, signs)

    def brought(heights: FloatArray) -> FloatArray:
        move = system.full((heights.reshape(-1, 1) * normals).ravel())
        return np.einsum("ij,ij->i", hessian.along(move)[columns], normals)

    values, vectors = eigsh(
        LinearOperator((size, size), matvec=brought, dtype=np.float64),
        count,
        stiffness,
        Minv=LinearOperator((size, size), matvec=solve, dtype=np.float64),
        which="LA",
        v0=1.0 + np.cos(SPREAD * np.arange(size)),
        tol=ROUGH,
        maxiter=ROUNDS,
    )
    found = [vectors[:, k] for k in np.argsort(-values) if values[k] > 0.0]
    upward = []
    for heights in found:
        side = _bent_to(system, vertices, signs, heights)
        side = side if abs(side) > CLEAR else _lies_to(heights)
        upward.append(heights if side > 0.0 else -heights)
    return [system.full(((heights / np.abs(heights).max())[:, None] * normals).ravel()) for heights in upward]


def is_bulge(system: System, vertices: FloatArray, lacking: FloatArray, mode: FloatArray) -> bool:
    """Return whether a move (n, 3) along the normals bends a surface to one side rather than to the other.

    Where K > 0 is lacking its bending tells, else whether the surface moves to one side.
    """
    if (lacking >= 0.0).any():
        heights = np.einsum("ij,ij->i", mode, vertex_normals(vertices, system.faces))[system.columns]
        return abs(_bent_to(system, vertices, np.where(lacking >= 0.0, 1.0, -1.0), heights)) > CLEAR
    mean = mode.mean(axis=0)
    return float(mean @ mean) > MEAN**2 * float(np.einsum("ij,ij->i", mode, mode).mean())


def _bent_to(system: System, vertices: FloatArray, signs: FloatArray, heights: FloatArray) -> float:
    """Return from -1 to 1 how far heights (c,) are bent to the side of the normals where K > 0 is lacking.

    The edges of a dome over columns within it come down by more than it rises: the heights themselves do not tell.
    """
    bent = -cotangent_laplacian(vertices, system.faces)[system.rows[signs > 0.0]][:, system.columns] @ heights
    return float(bent.sum()) / max(float(np.abs(bent).sum()), TINY)


def _lies_to(heights: FloatArray) -> float:
    """Return a number of the sign of the side that heights (c,) lie to on the whole."""
    side = float(np.sum(heights * np.abs(heights)))
    if abs(side) <= 1e-6 * float(np.sum(heights**2)):
        return float(heights[np.argmax(np.abs(heights) >= (1 - 1e-6) * np.abs(heights).max())])
    return side
