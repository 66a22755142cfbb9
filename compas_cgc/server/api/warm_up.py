"""Preparation of the server process for its first response, and of the process that writes files for its first file."""

from __future__ import annotations

from ...datastructures import CGCMesh
from ...discrete import gaussian_curvature
from ...solvers.run import solve
from ..errors import Unprocessable
from .formats import encoded
from .rhino_mesh import mesh_text
from .serialization import pack_result

__all__ = ["load_for_answers", "warm_up_writer"]


def load_for_answers() -> None:
    """Import the modules for responses of this process, so that the first response is not delayed."""
    vertices, faces = CGCMesh.from_meshgrid(dx=1, nx=1).arrays()
    gaussian_curvature(vertices, faces)
    try:
        mesh_text(vertices, faces)
    except ImportError:
        # Without rhino3dm, no response contains Rhino meshes.
        return


def warm_up_writer() -> None:
    """Write a file of a result, so that the first download is not delayed."""
    mesh = CGCMesh.from_meshgrid(dx=2, nx=2)
    mesh.set_supports("boundary")
    result = solve(mesh, method="flow", targets=0.01)
    try:
        encoded("3dm", pack_result(result, {}))
    except Unprocessable:
        # Without rhino3dm, downloads of this format report their own error.
        return
