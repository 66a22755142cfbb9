"""COMPAS .json: everything."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import FileError
from ._text import read_bytes

if TYPE_CHECKING:
    from ..datastructures import CGCMesh

__all__ = ["json_text", "read_json"]


def read_json(path: Path) -> CGCMesh:
    """Read a COMPAS .json file with a CGCMesh, or any other COMPAS mesh."""
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
    if isinstance(thing, CGCMesh):
        return thing
    if isinstance(thing, Mesh):
        return CGCMesh.from_mesh(thing)
    raise FileError(f"{path} holds a {type(thing).__name__}, no mesh; write a mesh with mesh.to_json()")


def json_text(mesh: CGCMesh) -> str:
    """Return a mesh as the text of a COMPAS .json file."""
    return mesh.to_jsonstring() + "\n"
