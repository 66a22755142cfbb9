"""Topology of meshes with creases and supports: checks, regions, dummy rings, crease paths."""

from __future__ import annotations

from .checks import Problem
from .checks import existence_problems
from .checks import mesh_problems
from .paths import crease_paths
from .paths import path_edges
from .regions import face_regions
from .ring import dummy_ring
from .triangulate import triangulate

__all__ = [
    "Problem",
    "crease_paths",
    "dummy_ring",
    "existence_problems",
    "face_regions",
    "mesh_problems",
    "path_edges",
    "triangulate",
]
