"""Load cases of an engineer's model: pressure, self weight, snow and wind."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..discrete import face_areas
from ..discrete import face_normals
from ..discrete.arrays import Faces
from ..discrete.arrays import FloatArray
from ..discrete.arrays import Vectors
from ..discrete.arrays import Vertices

__all__ = ["LoadCase", "snow_loads", "wind_loads"]


class LoadCase(NamedTuple):
    """A load on a surface: a uniform pressure, a uniform weight, and forces at vertices."""

    name: str
    pressure: float = 0.0  # along the normals [F/L^2]
    weight: float = 0.0  # downwards, per area of the surface [F/L^2]
    forces: FloatArray = np.zeros((0, 3))  # (n, 3) at the vertices [F], or empty


def snow_loads(vertices: Vertices, faces: Faces, snow: float) -> Vectors:
    """Return the forces at vertices (n, 3) of a downward load per area in plan [F]."""
    plan = np.abs(face_normals(vertices, faces)[:, 2]) * face_areas(vertices, faces)
    return _thirds(np.array([0.0, 0.0, -snow]) * plan[:, None], faces, len(vertices))


def wind_loads(vertices: Vertices, faces: Faces, wind: Vectors) -> Vectors:
    """Return the forces at vertices (n, 3) of a wind pressure vector (2,) in plan [F].

    The pressure along the normal n is ``wind . n``: it presses on faces that look to windward and lifts those to leeward, with
    the coefficient cos of the angle between wind and normal. Pressure zones of a standard are not included.
    """
    normals, areas = face_normals(vertices, faces), face_areas(vertices, faces)
    return _thirds((normals[:, :2] @ np.asarray(wind, dtype=np.float64) * areas)[:, None] * normals, faces, len(vertices))


def _thirds(loads: FloatArray, faces: Faces, count: int) -> Vectors:
    """Return loads of faces (m, 3) at the vertices (n, 3), a third at each corner."""
    total = np.zeros((count, 3))
    for corner in faces.T:
        np.add.at(total, corner, loads / 3.0)
    return total
