"""Areas of faces and of the cells around vertices."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..errors import names_what_was_meant
from . import _kernels
from .arrays import PerFace
from .arrays import PerVertex
from .arrays import mesh_arrays

__all__ = ["face_areas", "vertex_areas"]

KINDS = {"mixed": _kernels.MIXED, "voronoi": _kernels.VORONOI, "barycentric": _kernels.BARYCENTRIC}


def area_code(kind: str) -> int:
    """Return the kernels' number for an area's name."""
    if kind not in KINDS:
        raise ValueError(f"area kind must be one of {', '.join(KINDS)}, not {kind!r}")
    return KINDS[kind]


@names_what_was_meant()
def face_areas(vertices: ArrayLike, faces: ArrayLike) -> PerFace:
    """Return the area of every face.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.

    Returns
    -------
    (m,) float64
        Areas [L^2].

    Examples
    --------
    >>> face_areas(np.array([[0.0, 0, 0], [2, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])).tolist()
    [1.0]
    """
    V, F = mesh_arrays(vertices, faces)
    return 0.5 * np.linalg.norm(_kernels.cross_vectors(V, F), axis=1)


@names_what_was_meant()
def vertex_areas(vertices: ArrayLike, faces: ArrayLike, kind: str = "mixed") -> PerVertex:
    """Return the area of the cell around every vertex.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    kind
        ``"mixed"`` (default): Voronoi cells, made safe in obtuse triangles; always
        positive. ``"voronoi"``: circumcentric cells as they are, which can be negative
        on obtuse triangles. ``"barycentric"``: a third of every face. Each kind adds up
        to the area of the mesh.

    Returns
    -------
    (n,) float64
        Areas [L^2]; zero at vertices without faces.

    Raises
    ------
    MeshError
        If the arrays are not a triangle mesh.
    ValueError
        If the kind is unknown.

    References
    ----------
    Paper, Section 3.1, ``A_i`` of Eq. 10. Mixed cells: Meyer, Desbrun, Schroeder, Barr,
    doi:10.1007/978-3-662-05105-4_2.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]])
    >>> float(round(vertex_areas(square, np.array([[0, 1, 2], [0, 2, 3]])).sum(), 9))
    4.0
    """
    code = area_code(kind)
    V, F = mesh_arrays(vertices, faces)
    return _kernels.angle_sums_and_areas(V, F, code)[1]
