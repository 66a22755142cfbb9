"""COMPAS .json files, which hold all data of a problem."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import FileError
from ..model.problem import PosesProblem
from .cleanup import check_mesh
from .cursor import Cursor
from .cursor import reason_of

if TYPE_CHECKING:
    from ..datastructures import CGCMesh

__all__ = ["json_text", "read_json"]


def read_json(path: Path) -> CGCMesh:
    """Read a COMPAS .json file with a CGCMesh, or any other COMPAS mesh.

    Raises
    ------
    FileError
        If the file holds no mesh, an invalid constraint or an unsupported type.
    """
    from compas.datastructures import Mesh

    from ..datastructures import CGCMesh
    from ..datastructures.compas_data import objects_of

    cursor = Cursor.of_file(path)
    try:
        value = json.loads(cursor.data.decode("utf-8-sig"))
        cursor.check_nesting(value)
        thing = objects_of(value)
        if not isinstance(thing, Mesh):
            raise FileError(f"it holds a {type(thing).__name__} instead of a mesh")
        mesh = thing if isinstance(thing, CGCMesh) else CGCMesh.from_mesh(thing)
        place = {key: i for i, key in enumerate(mesh.vertex)}
        points = [[own[axis] for axis in "xyz"] for own in mesh.vertex.values()]
        vertices = np.array(points, dtype=np.float64).reshape(-1, 3)
        faces = [[place[v] for v in face] for face in mesh.face.values()]
    except json.JSONDecodeError as error:
        raise FileError(f"{path} is not valid JSON (line {error.lineno}: {error.msg}); export it again") from None
    except Exception as error:
        # The classes of COMPAS do not check their data, so wrong data can raise any error.
        raise FileError(f"{path} cannot be read as COMPAS data ({reason_of(error)}); write it with mesh.to_json()") from error
    check_mesh(path, vertices, faces)
    try:
        mesh.goals()
    except ValueError as error:
        raise FileError(f"{path}: {error}; set the goals again (mesh.set_goals)") from None
    return mesh


def json_text(surface: PosesProblem) -> str:
    """Return a mesh, or the mesh of a result or problem, as the text of a COMPAS .json file."""
    from ..datastructures import CGCMesh

    mesh = surface if isinstance(surface, CGCMesh) else getattr(surface, "mesh", None) or CGCMesh.from_problem(surface.to_problem())
    return mesh.to_jsonstring() + "\n"
