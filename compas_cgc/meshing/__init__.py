"""Mesh topology: checks, boundaries, regions, creases, dummy rings, triangulation."""

from __future__ import annotations

from .boundary import boundary_loops
from .boundary import named_supports
from .checks import Diagnostic
from .checks import mesh_problems
from .creases import crease_paths
from .creases import lost_edges
from .creases import path_edges
from .dummy_mesh import dummy_ring
from .existence import existence_problems
from .regions import face_means
from .regions import face_regions
from .regions import vertex_labels
from .triangulate import triangles_of
from .triangulate import triangulate

__all__ = [
    "Diagnostic",
    "boundary_loops",
    "crease_paths",
    "dummy_ring",
    "existence_problems",
    "face_means",
    "face_regions",
    "lost_edges",
    "mesh_problems",
    "named_supports",
    "path_edges",
    "triangles_of",
    "triangulate",
    "vertex_labels",
]
