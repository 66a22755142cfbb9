"""Development onto the plane."""

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

    plane: FloatArray  # (k, 2) places of its vertices, of which a seam has two [L]
    faces: Faces  # (m, 3) into these
    origin: IntArray  # (k,) vertex in space of each
    gap: float  # largest distance between the places that faces give to one vertex [L]
    edge_error: float  # largest relative difference between an edge in the plane and in space


@names_what_was_meant()
def unfold(vertices: ArrayLike, faces: ArrayLike, seams: Optional[ArrayLike] = None) -> PlaneLayout:
    """Lay a mesh out in the plane, face after face.

    Every face keeps its shape, and a rigid motion carries it to the edge that it shares with the one before it, breadth
    first from the middle. Lengths are not taken off circles, so that errors do not grow from ring to ring. Where the
    mesh is flat (no angle defect) and its seams open it to a disk the faces close up, and `gap` is at rounding.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices of an oriented manifold.
    seams
        ``(s, 2)`` edges that are cut. Default: none.

    Returns
    -------
    PlaneLayout
        Each connected part about an origin of its own, normals up.

    Raises
    ------
    MeshError
        If the arrays are no oriented manifold.

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
