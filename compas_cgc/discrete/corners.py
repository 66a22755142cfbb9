"""Angles at the corners of triangles."""

from __future__ import annotations

import numpy as np

from .arrays import Faces
from .arrays import FloatArray
from .arrays import Vertices

__all__ = ["corner_angles"]


def corner_angles(vertices: Vertices, faces: Faces) -> FloatArray:
    """Return the angles of triangles (m, 3) [rad], exact for needles too."""
    corners = vertices[faces]
    ahead, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    cross = np.cross(ahead, back)
    doubled = np.sqrt(np.einsum("ijk,ijk->ij", cross, cross))
    return np.asarray(np.arctan2(doubled, np.einsum("ijk,ijk->ij", ahead, back)), dtype=np.float64)
