"""What the process of the server loads before its first answer."""

from __future__ import annotations

from ...datastructures import CGCMesh
from ...discrete import gaussian_curvature
from .rhino_mesh import mesh_text

__all__ = ["load_for_answers"]


def load_for_answers() -> None:
    """Load what the answers that are made here take, so that nobody waits while the first of them loads it."""
    vertices, faces = CGCMesh.from_meshgrid(dx=1, nx=1).arrays()
    gaussian_curvature(vertices, faces)
    try:
        mesh_text(vertices, faces)
    except ImportError:
        # Without rhino3dm there are no answers with its meshes.
        return
