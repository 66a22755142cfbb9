"""Development of developable meshes onto the plane."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional

from numpy.typing import ArrayLike

from ..discrete import edge_faces
from ..discrete import mesh_arrays
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import names_what_was_meant
from .layout import among
from .layout import lay

__all__ = ["PlaneLayout", "unfold"]


class PlaneLayout(NamedTuple):
    """A mesh in the plane, opened along its seams."""

    plane: FloatArray  # (k, 2) positions of vertices; a vertex on a seam has several [L]
    faces: Faces  # (m, 3) indices into `plane`
    origin: IntArray  # (k,) mesh vertex of every position
    gap: float  # largest distance between the positions of a vertex in different faces [L]
    edge_error: float  # largest relative difference between an edge in the plane and in space


@names_what_was_meant()
def unfold(vertices: ArrayLike, faces: ArrayLike, seams: Optional[ArrayLike] = None) -> PlaneLayout:
    """Unfold a mesh to the plane, face by face.

    Every face keeps its shape and moves rigidly to the edge shared with its predecessor, breadth first from the centre. If the
    mesh has no angle defects and its seams open it to a disk, the faces close and `gap` is at rounding level.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices of an oriented manifold.
    seams
        ``(s, 2)`` edges to cut. Default: none.

    Returns
    -------
    PlaneLayout
        Layout with normals up; each connected part has its own origin.

    Raises
    ------
    MeshError
        If the arrays do not form an oriented manifold.

    Examples
    --------
    >>> import numpy as np
    >>> roof = np.array([[0, 0, 0], [3, 0, 0], [3, 1, 1], [0, 1, 1.0]])
    >>> type(unfold(roof, np.array([[0, 1, 2], [0, 2, 3]]))).__name__
    'PlaneLayout'
    """
    V, F = mesh_arrays(vertices, faces)
    edges = edge_faces(F)
    laid = lay(V, F, edges[(edges[:, 3] >= 0) & ~among(edges[:, :2], seams, len(V))], 0.0)
    return PlaneLayout(laid.points[:, 1:].copy(), laid.faces, laid.origin, laid.gap, laid.edge_error)
