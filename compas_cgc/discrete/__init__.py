"""Discrete curvature of triangle meshes: arrays in, arrays out.

Every function takes ``vertices`` ``(n, 3)`` and ``faces`` ``(m, 3)``, counterclockwise
seen from outside, and knows nothing of roles, files or COMPAS objects.
"""

from __future__ import annotations

from .areas import face_areas
from .areas import vertex_areas
from .arrays import MeshError
from .arrays import mesh_arrays
from .curvature import angle_defects
from .curvature import gaussian_curvature
from .energy import energy
from .energy import energy_gradient
from .mean import mean_curvature
from .mean import total_mean_curvature
from .normals import face_normals
from .normals import vertex_normals
from .topology import boundary_vertices
from .topology import edge_faces
from .volume import enclosed_volume

__all__ = [
    "MeshError",
    "angle_defects",
    "boundary_vertices",
    "edge_faces",
    "enclosed_volume",
    "energy",
    "energy_gradient",
    "face_areas",
    "face_normals",
    "gaussian_curvature",
    "mean_curvature",
    "mesh_arrays",
    "total_mean_curvature",
    "vertex_areas",
    "vertex_normals",
]
