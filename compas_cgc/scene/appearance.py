"""Appearance of CGC meshes: options of scene objects."""

from __future__ import annotations

from typing import TYPE_CHECKING

from compas.colors import Color

from .figures import coloured

if TYPE_CHECKING:
    from ..datastructures import CGCMesh

__all__ = ["CREASE", "SUPPORT", "appearance", "real_mesh"]

SUPPORT = Color.from_rgb255(200, 30, 30)
CREASE = Color.from_rgb255(20, 60, 160)


def real_mesh(mesh: CGCMesh) -> CGCMesh:
    """Return the mesh, or a copy without its dummies if it has any."""
    return mesh.without_dummies() if any(mesh.is_dummy(key) for key in mesh.vertices()) else mesh


def appearance(mesh: CGCMesh, show: str) -> dict:
    """Return the options of a mesh object: supports as vertices, creases as edges, a quantity as vertex colours.

    Parameters
    ----------
    mesh
        The mesh, without dummies.
    show
        A name in :data:`compas_cgc.scene.figures.FIGURES`.
    """
    colours = coloured(mesh, show).colours.tolist()
    return {
        "show_vertices": mesh.supports(),
        "show_edges": mesh.crease_edges(),
        "vertexcolor": {key: Color.from_rgb255(*colour) for key, colour in zip(mesh.vertices(), colours)},
        "edgecolor": CREASE,
    }
