"""COMPAS plugins for the methods ``from_3dm``, ``to_3dm`` and ``from_surface`` of CGCMesh."""

from __future__ import annotations

import os
from typing import Any
from typing import Union

from compas.plugins import plugin

from ..datastructures import CGCMesh
from ..errors import MeshError
from .registry import read
from .registry import write

__all__ = ["mesh_from_3dm", "mesh_from_brep", "mesh_to_3dm"]

TOLERANCE = 1e-3  # distance below which corners of faces coincide, relative to the edge length


@plugin(category="cgc_files")
def mesh_from_3dm(path: Union[str, os.PathLike], **options: object) -> CGCMesh:
    """Return the mesh in a Rhino file with its supports, creases, targets and goals."""
    return read(path, **options)  # type: ignore[arg-type]


@plugin(category="cgc_files")
def mesh_from_brep(geometry: Any, edge_length: float) -> CGCMesh:
    """Return a mesh of a Brep, an extrusion or a SubD, with its sharp joints as creases."""
    from .rhino.rhinocommon import problem_from_surfaces

    if not hasattr(geometry, "GetBoundingBox"):
        kinds = "a surface of COMPAS, rhino3dm or Rhino, or a Brep, an extrusion or a SubD"
        raise MeshError(f"a {type(geometry).__name__} is not a surface; give {kinds}")
    found = problem_from_surfaces([geometry], edge_length, tolerance=TOLERANCE * edge_length, units="None")
    return CGCMesh.from_problem(found.checked())


@plugin(category="cgc_files")
def mesh_to_3dm(mesh: CGCMesh, path: Union[str, os.PathLike], version: int = 7) -> None:
    """Write a mesh with its supports, creases, targets and goals as a Rhino file."""
    write(path, mesh, version=version)
