"""Mean curvature, at vertices and in total."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..errors import names_what_was_meant
from . import _kernels
from .areas import area_code
from .arrays import Faces
from .arrays import PerVertex
from .arrays import Vertices
from .arrays import mesh_arrays
from .topology import boundary_mask
from .topology import closed_vertices
from .topology import edge_faces

__all__ = ["mean_curvature", "total_mean_curvature"]


def _signed_lengths(V: Vertices, F: Faces) -> PerVertex:
    """Return ½ |A_i H_i| of Eq. 14 with the sign of convexity (n,): positive where H_i points inwards."""
    vectors = _kernels.mean_curvature_vectors(V, F)
    normals = _kernels.sum_at_vertices(len(V), F, _kernels.cross_vectors(V, F))
    inward = -np.einsum("ij,ij->i", vectors, normals)
    return 0.5 * np.copysign(np.linalg.norm(vectors, axis=1), inward)


@names_what_was_meant()
def mean_curvature(vertices: ArrayLike, faces: ArrayLike, areas: str = "mixed") -> PerVertex:
    """Return the mean curvature of every vertex by the cotangent Laplacian.

    Positive where the surface is convex towards its normal, +1/r on a sphere of radius
    r. (The paper's ``H`` has the opposite sign.)

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
        Curvatures [1/L]; NaN on an open boundary and at vertices without faces.

    References
    ----------
    Paper, Eq. 14.

    Examples
    --------
    >>> pyramid = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 1]], dtype=float)
    >>> float(round(mean_curvature(pyramid, np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]))[4], 4))
    0.6667
    """
    code = area_code(areas)
    V, F = mesh_arrays(vertices, faces)
    _, area = _kernels.angle_sums_and_areas(V, F, code)
    with np.errstate(divide="ignore", invalid="ignore"):
        H = _signed_lengths(V, F) / area
    H[boundary_mask(len(V), F) | (area == 0)] = np.nan
    return H


@names_what_was_meant()
def total_mean_curvature(vertices: ArrayLike, faces: ArrayLike, kind: str = "steiner") -> float:
    """Return the integral of the mean curvature, positive on convex surfaces.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices, counterclockwise seen from outside.
    kind
        ``"steiner"`` (default): half the sum of edge length times exterior dihedral
        angle, over the edges between two faces; its gradient is known in closed form.
        ``"cotangent"``: the paper's sum over the vertices inside the mesh.

    Returns
    -------
    float
        Total mean curvature [L]; ``4 pi r`` on a sphere of radius r.

    Raises
    ------
    MeshError
        If the arrays are not an oriented triangle mesh.
    ValueError
        If the kind is unknown.

    References
    ----------
    Paper, Eq. 15. Steiner's formula: Bobenko, Schroeder, Sullivan, Ziegler,
    *Discrete Differential Geometry*, doi:10.1007/978-3-7643-8621-4.

    Examples
    --------
    >>> cube = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    >>> round(total_mean_curvature(cube, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])), 4)
    6.994
    """
    V, F = mesh_arrays(vertices, faces)
    if kind == "steiner":
        return float(_kernels.total_fold(V, _kernels.cross_vectors(V, F), edge_faces(F)))
    if kind == "cotangent":
        return float(_signed_lengths(V, F)[closed_vertices(V, F)].sum())
    raise ValueError(f"kind must be 'steiner' or 'cotangent', not {kind!r}")
