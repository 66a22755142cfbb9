"""Unit normals of faces and vertices."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..errors import names_what_was_meant
from . import _kernels
from .arrays import Vectors
from .arrays import mesh_arrays

__all__ = ["face_normals", "unit_vectors", "vertex_normals"]


def unit_vectors(vectors: Vectors) -> Vectors:
    """Return vectors ``(n, 3)`` at length one, as in Eq. 13, zero where they have none."""
    length = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))
    length[length == 0.0] = 1.0
    return vectors / length[:, None]


@names_what_was_meant()
def face_normals(vertices: ArrayLike, faces: ArrayLike) -> Vectors:
    """Return the outward unit normal of every face (Eq. 17).

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside.

    Returns
    -------
    (m, 3) float64
        Unit vectors; zero where a face has no area.

    Examples
    --------
    >>> face_normals(np.array([[0.0, 0, 0], [2, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])).tolist()
    [[0.0, 0.0, 1.0]]
    """
    V, F = mesh_arrays(vertices, faces)
    return unit_vectors(_kernels.cross_vectors(V, F))


@names_what_was_meant()
def vertex_normals(vertices: ArrayLike, faces: ArrayLike) -> Vectors:
    """Return the outward unit normal of every vertex (Eq. 13): the area-weighted mean (Eq. 12) of its faces (Eq. 11).

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside.

    Returns
    -------
    (n, 3) float64
        Unit vectors; zero where the faces cancel or where there are none.

    Examples
    --------
    >>> vertex_normals(np.array([[0.0, 0, 0], [2, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))[0].tolist()
    [0.0, 0.0, 1.0]
    """
    V, F = mesh_arrays(vertices, faces)
    return unit_vectors(_kernels.sum_at_vertices(len(V), F, _kernels.cross_vectors(V, F)))
