"""Projection of a mesh."""

from __future__ import annotations

from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np
from numpy.typing import ArrayLike
from numpy.typing import NDArray

from ..discrete import face_normals
from ..discrete import mesh_arrays
from ..discrete.arrays import FloatArray
from ..discrete.arrays import IntArray
from ..errors import MeshError
from ..model.roles import DUMMY
from .view import Frame
from .view import View
from .view import frame_of
from .view import project
from .view import used_vertices
from .view import view_named

__all__ = ["Seen", "edge_array", "look", "real_faces"]


class Seen(NamedTuple):
    """A projected mesh."""

    corners: FloatArray  # (n, 3) projected vertices, and nearness [L]
    faces: IntArray  # (m, 3) visible faces
    real: NDArray[np.bool_]  # (m,) whether a face is not a dummy face
    normals: FloatArray  # (m, 3) unit normals
    frame: Frame  # visible part of the projection

    @property
    def triangles(self) -> FloatArray:
        """Projected faces (m, 3, 2) [L]."""
        return self.corners[self.faces, :2]

    @property
    def nearness(self) -> FloatArray:
        """Nearness of the centre of every face (m,) [L]."""
        return self.corners[self.faces, 2].mean(axis=1)

    @property
    def used(self) -> NDArray[np.bool_]:
        """Mask of the vertices of visible faces (n,)."""
        return used_vertices(len(self.corners), self.faces)


def look(vertices: ArrayLike, faces: ArrayLike, roles: ArrayLike, view: Union[str, View], dummies: bool = True) -> Seen:
    """Return the projection of a mesh.

    Parameters
    ----------
    vertices
        ``(n, 3)`` coordinates [L].
    faces
        ``(m, 3)`` vertex indices.
    roles
        ``(n,)`` index into :data:`compas_cgc.model.roles.ROLES`.
    view
        ``"diagonal"``, ``"plan"`` or a :class:`View`.
    dummies
        Whether to show dummy faces.

    Raises
    ------
    MeshError
        If the arrays are not a triangle mesh, or there is not one role per vertex.
    """
    V, F = mesh_arrays(vertices, faces)
    if np.shape(roles) != (len(V),):
        raise MeshError(f"roles must be one per vertex ({len(V)}), not of shape {np.shape(roles)}")
    real = real_faces(F, roles)
    if not dummies:
        F, real = F[real], real[real]
    used = used_vertices(len(V), F)
    corners = project(V, view_named(view), V[used] if used.any() else V)
    return Seen(corners, F, real, face_normals(V, F), frame_of(corners[used, :2]))


def real_faces(faces: ArrayLike, roles: ArrayLike) -> NDArray[np.bool_]:
    """Return a mask of the faces without a dummy vertex (m,)."""
    return ~(np.asarray(roles) == DUMMY)[np.asarray(faces)].any(axis=1)


def edge_array(edges: Optional[ArrayLike], used: NDArray[np.bool_]) -> IntArray:
    """Return edges as an array (e, 2), without edges at unused vertices."""
    E = np.asarray([] if edges is None else edges, dtype=np.int64).reshape(-1, 2)
    if E.size and (E.min() < 0 or E.max() >= len(used)):
        raise MeshError(f"a crease refers to a vertex that does not exist: {E.min()} to {E.max()} of {len(used)} vertices")
    return E[used[E].all(axis=1)]
