"""What is asked of the regions of a mesh, as files hold it."""

from __future__ import annotations

from typing import TYPE_CHECKING
from typing import Optional

import numpy as np

from ..discrete.arrays import IntArray

if TYPE_CHECKING:
    from ..datastructures import CGCMesh

__all__ = ["region_faces", "region_targets"]


def region_faces(mesh: CGCMesh) -> IntArray:
    """Return the region of every real face, in the order of ``mesh.arrays()`` (m,)."""
    region = {face: number for number, faces in enumerate(mesh.regions()) for face in faces}
    return np.array([region[face] for face in mesh.faces() if face in region], dtype=np.int64)


def region_targets(mesh: CGCMesh) -> list[Optional[float]]:
    """Return the target of every region, None where it is not one number [1/L^2].

    What counts are the vertices where K is asked, or else all but those on creases.
    """
    found: list[Optional[float]] = []
    for faces in mesh.regions():
        keys = dict.fromkeys(v for face in faces for v in mesh.face_vertices(face))
        asked = {mesh.vertex_target(v) for v in keys if mesh.vertex_role(v) == "internal"}
        values = asked or {mesh.vertex_target(v) for v in keys if mesh.vertex_role(v) != "crease"}
        found.append(values.pop() if len(values) == 1 else None)
    return found
