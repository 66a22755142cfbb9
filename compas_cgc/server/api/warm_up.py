"""Imports of the server process before its first response."""

from __future__ import annotations

from ...datastructures import CGCMesh
from ...discrete import gaussian_curvature
from .rhino_mesh import mesh_text

__all__ = ["load_for_answers"]


def load_for_answers() -> None:
    """Import the modules for responses of this process, so that the first response is not delayed."""
    vertices, faces = CGCMesh.from_meshgrid(dx=1, nx=1).arrays()
    gaussian_curvature(vertices, faces)
    try:
        mesh_text(vertices, faces)
    except ImportError:
        # Without rhino3dm, no response contains Rhino meshes.
        return
