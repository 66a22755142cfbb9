"""Gaussian curvature as angle defect over area (Eq. 10)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..errors import names_what_was_meant
from . import _kernels
from .areas import area_code
from .arrays import PerVertex
from .arrays import mesh_arrays
from .topology import boundary_mask

__all__ = ["angle_defects", "gaussian_curvature"]


@names_what_was_meant()
def angle_defects(vertices: ArrayLike, faces: ArrayLike) -> PerVertex:
    """Return the angle defect of every vertex.

    Inside the mesh ``2 pi`` less the sum of the angles, which is the curvature that the
    vertex holds; on an open boundary ``pi`` less that sum, which is how far the boundary
    turns there. So the defects always add up to ``2 pi`` times the Euler characteristic.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside.

    Returns
    -------
    (n,) float64
        Defects [rad]; zero at vertices without faces.

    Raises
    ------
    MeshError
        If the arrays are not a triangle mesh.

    References
    ----------
    Paper, Eq. 10 (the bracket).

    Examples
    --------
    >>> pyramid = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 1]], dtype=float)
    >>> sides = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    >>> np.round(angle_defects(pyramid, sides), 6).tolist()[4]
    1.359348
    """
    V, F = mesh_arrays(vertices, faces)
    angle, _ = _kernels.angle_sums_and_areas(V, F, _kernels.BARYCENTRIC)
    defect = np.where(boundary_mask(len(V), F), np.pi, 2 * np.pi) - angle
    defect[np.bincount(F.ravel(), minlength=len(V)) == 0] = 0.0
    return defect


@names_what_was_meant()
def gaussian_curvature(vertices: ArrayLike, faces: ArrayLike, areas: str = "mixed") -> PerVertex:
    """Return the Gaussian curvature of every vertex: angle defect over cell area.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside.
    areas
        Kind of the cells, see :func:`vertex_areas`.

    Returns
    -------
    (n,) float64
        Curvatures [1/L^2]; NaN on an open boundary, where it is not defined, and at
        vertices without faces.

    Raises
    ------
    MeshError
        If the arrays are not a triangle mesh.
    ValueError
        If the kind of area is unknown.

    References
    ----------
    Paper, Eq. 10.

    Examples
    --------
    >>> vertices = [[0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]]
    >>> K = gaussian_curvature(vertices, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]], areas="barycentric")
    >>> round(float(K[0] * 4 * 3**0.5 / 6 * 3 / 3.141592653589793), 6)  # 2 pi / 3 over 2 / sqrt 3
    2.0
    """
    code = area_code(areas)
    V, F = mesh_arrays(vertices, faces)
    angle, area = _kernels.angle_sums_and_areas(V, F, code)
    with np.errstate(divide="ignore", invalid="ignore"):
        K = (2 * np.pi - angle) / area
    K[boundary_mask(len(V), F) | (area == 0)] = np.nan
    return K
