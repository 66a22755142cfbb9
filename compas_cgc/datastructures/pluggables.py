"""Pluggables: what a CGCMesh can do where other parts of the package are there to do it."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING
from typing import Union

from compas.plugins import pluggable

if TYPE_CHECKING:
    from .cgcmesh import CGCMesh

__all__ = ["mesh_from_3dm", "mesh_to_3dm"]


@pluggable(category="cgc_files")
def mesh_from_3dm(path: Union[str, os.PathLike], **options: object) -> CGCMesh:
    """Return the mesh in a Rhino file with its supports, creases, targets and constraints."""
    raise NotImplementedError


@pluggable(category="cgc_files")
def mesh_to_3dm(mesh: CGCMesh, path: Union[str, os.PathLike], version: int = 7) -> None:
    """Write a mesh with its supports, creases, targets and constraints as a Rhino file."""
    raise NotImplementedError
