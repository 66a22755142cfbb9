"""Cotangent Laplacian."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from . import _derivatives
from .arrays import Vertices
from .arrays import mesh_arrays
from .sparsity import RingPattern

__all__ = ["cotangent_laplacian", "cotangent_stiffness"]


def cotangent_laplacian(vertices: ArrayLike, faces: ArrayLike) -> sparse.csr_matrix:
    """Return the cotangent Laplacian of a mesh.

    ``(L u)_i = ½ Σ_j (cot a_ij + cot b_ij) (u_j - u_i)``: the integral of the Laplacian
    of u over the cell of vertex i. Boundary edges count their one angle.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.

    Returns
    -------
    csr_matrix
        ``(n, n)`` symmetric, negative semidefinite, without dimension. Faces without area
        add nothing.

    Raises
    ------
    MeshError
        If the arrays are not a triangle mesh.

    References
    ----------
    Paper, Eq. 14. Pinkall, Polthier, doi:10.1080/10586458.1993.10504266.
    """
    V, F = mesh_arrays(vertices, faces)
    everywhere = np.arange(len(V))
    return -cotangent_stiffness(V, RingPattern(F, len(V), everywhere, everywhere))


def cotangent_stiffness(vertices: Vertices, pattern: RingPattern) -> sparse.csr_matrix:
    """Return the negative cotangent Laplacian on the rows and columns of a pattern.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    pattern
        Sparsity; with equal rows and columns the matrix is symmetric and, when some
        vertex of every part is left out, positive definite.
    """
    return pattern.matrix(_derivatives.stiffness(vertices, pattern.faces, pattern.slots, pattern.size))
