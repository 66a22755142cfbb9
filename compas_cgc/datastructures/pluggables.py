"""Pluggables of CGCMesh that other parts of the package implement."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any
from typing import Optional
from typing import Union

from compas.datastructures import Mesh
from compas.plugins import pluggable

__all__ = ["mesh_from_3dm", "mesh_from_brep", "mesh_to_3dm"]


@pluggable(category="cgc_files")
def mesh_from_3dm(path: Union[str, os.PathLike[str]], **options: object) -> Any:
    """Return the mesh in a Rhino file with its supports, creases, targets and goals."""
    return _plugin("mesh_from_3dm")(path, **options)


@pluggable(category="cgc_files")
def mesh_from_brep(geometry: Any, edge_length: float) -> Any:
    """Return a mesh of a Brep, an extrusion or a SubD of rhino3dm, with its sharp joints as creases."""
    return _plugin("mesh_from_brep")(geometry, edge_length)


@pluggable(category="cgc_files")
def mesh_to_3dm(mesh: Mesh, path: Union[str, os.PathLike[str]], version: int = 7) -> None:
    """Write a mesh with its supports, creases, targets and goals as a Rhino file."""
    _plugin("mesh_to_3dm")(mesh, path, version)


def _plugin(name: str) -> Callable[..., Any]:
    """Return an implementation from the package itself; COMPAS does not find plugins of editable installs."""
    package = sys.modules[__name__.partition(".")[0]]
    for module in package.__all_plugins__:
        found: Optional[Callable[..., Any]] = getattr(import_module(module), name, None)
        if found is not None:
            return found
    raise NotImplementedError
