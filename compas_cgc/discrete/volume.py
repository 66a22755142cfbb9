"""Enclosed volume (Eq. 19)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..errors import names_what_was_meant
from . import _kernels
from .arrays import mesh_arrays

__all__ = ["enclosed_volume"]


@names_what_was_meant()
def enclosed_volume(vertices: ArrayLike, faces: ArrayLike) -> float:
    """Return the signed volume of the pyramids from the origin to every face.

    For a closed mesh that is the volume inside, wherever the origin is; for an open one
    the volume of the cone over it.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside.

    Returns
    -------
    float
        Volume [L^3].

    References
    ----------
    Paper, Eq. 19, the sum of Eq. 16.

    Examples
    --------
    >>> tetrahedron = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    >>> round(enclosed_volume(tetrahedron, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])), 6)
    0.166667
    """
    V, F = mesh_arrays(vertices, faces)
    return float(_kernels.pyramids(V, F, np.ones(len(F))))
