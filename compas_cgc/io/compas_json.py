"""COMPAS .json: everything."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import FileError
from ..model.problem import PosesProblem
from ._files import read_bytes

if TYPE_CHECKING:
    from ..datastructures import CGCMesh

__all__ = ["json_text", "read_json"]


def read_json(path: Path) -> CGCMesh:
    """Read a COMPAS .json file with a CGCMesh, or any other COMPAS mesh.

    Raises
    ------
    FileError
        If it holds no mesh, or a constraint on it that is none.
    """
    from compas.data import DecoderError
    from compas.data import json_loads
    from compas.datastructures import Mesh

    from ..datastructures import CGCMesh

    try:
        thing = json_loads(read_bytes(path).decode("utf-8-sig"))
    except json.JSONDecodeError as error:
        raise FileError(f"{path} is no JSON (line {error.lineno}: {error.msg}); export it again") from None
    except (UnicodeDecodeError, DecoderError, AttributeError, ImportError, IndexError, KeyError, TypeError, ValueError) as error:
        raise FileError(f"{path} cannot be read as COMPAS data ({error}); write it with mesh.to_json()") from None
    if not isinstance(thing, Mesh):
        raise FileError(f"{path} holds a {type(thing).__name__}, no mesh; write a mesh with mesh.to_json()")
    mesh = thing if isinstance(thing, CGCMesh) else CGCMesh.from_mesh(thing)
    try:
        mesh.constraints()
    except ValueError as error:
        raise FileError(f"{path}: {error}; set the constraints again (mesh.set_constraints)") from None
    return mesh


def json_text(surface: PosesProblem) -> str:
    """Return a mesh, the mesh of a result or that of a problem as the text of a COMPAS .json file."""
    from ..datastructures import CGCMesh

    mesh = surface if isinstance(surface, CGCMesh) else getattr(surface, "mesh", None) or CGCMesh.from_problem(surface.to_problem())
    return mesh.to_jsonstring() + "\n"
