"""Plugins: Rhino files for the methods ``from_3dm`` and ``to_3dm`` of a CGCMesh; COMPAS finds them."""

from __future__ import annotations

import os
from typing import Union

from compas.plugins import plugin

from ..datastructures import CGCMesh
from .registry import read
from .registry import write

__all__ = ["mesh_from_3dm", "mesh_to_3dm"]


@plugin(category="cgc_files")
def mesh_from_3dm(path: Union[str, os.PathLike], **options: object) -> CGCMesh:
    """Return the mesh in a Rhino file with its supports, creases, targets and constraints."""
    return read(path, **options)  # type: ignore[arg-type]


@plugin(category="cgc_files")
def mesh_to_3dm(mesh: CGCMesh, path: Union[str, os.PathLike], version: int = 7) -> None:
    """Write a mesh with its supports, creases, targets and constraints as a Rhino file."""
    write(path, mesh, version=version)
