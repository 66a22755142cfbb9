"""COMPAS .json files, which hold all data of a problem."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Any
from typing import Optional

import numpy as np

from ..errors import FileError
from ..meshing.cleanup import Omission
from ..model.counts import counted
from ..model.given import plan_direction
from ..model.problem import Drawing
from ..model.problem import PosesProblem
from .cleanup import check_mesh
from .cursor import Cursor
from .cursor import reason_of

if TYPE_CHECKING:
    from ..datastructures import CGCMesh

__all__ = ["json_text", "read_json"]

# Keys of COMPAS data that are no names of what is inside of them.
UNNAMED = ("CGCMesh", "Mesh")
WRAPPERS = ("data", "value", "item", "items", "objects")


def read_json(path: Path, name: Optional[str] = None) -> tuple[CGCMesh, list[str]]:
    """Read the mesh in a file of COMPAS data: a mesh, or a list, dictionary or scene with one.

    Data of COMPAS 0, 1 and 2 is read. Of types that are not meshes nothing is imported.

    Parameters
    ----------
    path
        The file.
    name
        Name of the mesh, or its key in a dictionary. Needed where there are several.

    Returns
    -------
    mesh, notes
        The mesh, and sentences on what was left out.

    Raises
    ------
    FileError
        If it holds no mesh, several to choose from, an invalid goal, or a type that is not read.
    """
    cursor = Cursor.of_file(path)
    try:
        value = json.loads(cursor.data.decode("utf-8-sig"))
        cursor.check_nesting(value)
        meshes, others = _found_in(value)
        key, chosen = _chosen(meshes, others, name)
        mesh = _mesh_of(chosen)
        # COMPAS calls objects without a name by their class.
        if mesh.name in UNNAMED:
            mesh.name = path.stem
        plan_direction(mesh.attributes.get("north", Drawing().north), "the direction of north")
        place = {key: i for i, key in enumerate(mesh.vertex)}
        points = [[own[axis] for axis in "xyz"] for own in mesh.vertex.values()]
        vertices = np.array(points, dtype=np.float64).reshape(-1, 3)
        faces = [[place[v] for v in face] for face in mesh.face.values()]
    except json.JSONDecodeError as error:
        raise FileError(f"{path} is not valid JSON (line {error.lineno}: {error.msg}); export it again") from None
    except FileError as error:
        raise FileError(f"{path}: {error}") from None
    except Exception as error:
        # The classes of COMPAS do not check their data, so wrong data can raise any error.
        raise FileError(f"{path} cannot be read as COMPAS data ({reason_of(error)}); write it with mesh.to_json()") from error
    check_mesh(path, vertices, faces)
    try:
        mesh.goals()
    except ValueError as error:
        raise FileError(f"{path}: {error}; set the goals again (mesh.set_goals)") from None
    left = [counted(count, kind) for kind, count in sorted(Counter(others).items())]
    left += [f"the mesh {other!r}" for other, _ in meshes if other != key]
    return mesh, [Omission(f"beside the mesh the file holds {', '.join(left)}, which was not read")] if left else []


def _found_in(value: Any) -> tuple[list[tuple[str, dict]], list[str]]:
    """Return the meshes in parsed JSON, each with its name, and the types of all other COMPAS objects."""
    meshes: list[tuple[str, dict]] = []
    others: list[str] = []

    def look(node: Any, key: str) -> None:
        if isinstance(node, list):
            for k, item in enumerate(node):
                look(item, f"{key}[{k}]" if key else str(k))
        elif isinstance(node, dict) and _is_mesh(node):
            meshes.append((_name_of(node, key), node))
        elif isinstance(node, dict):
            kind = str(node["dtype"]).rpartition("/")[2] if "dtype" in node else ""
            # What is inside of a scene or group is looked at, and not the inside of a curve.
            before = len(meshes)
            for own, item in node.items():
                look(item, own if own not in WRAPPERS else key)
            if kind and len(meshes) == before:
                others.append(kind)

    look(value, "")
    return meshes, others


def _is_mesh(node: dict) -> bool:
    if "dtype" in node:
        bases = node.get("inheritance")
        return any(str(kind).endswith("Mesh") for kind in (node["dtype"], *(bases if isinstance(bases, list) else [])))
    return isinstance(node.get("vertex"), dict) and isinstance(node.get("face"), dict)


def _name_of(node: dict, key: str) -> str:
    inner = node.get("data") or node.get("value") or node
    attributes = inner.get("attributes") if isinstance(inner, dict) else None
    own = node.get("name") or (attributes.get("name") if isinstance(attributes, dict) else None)
    return key or str(own or "Mesh")


def _chosen(meshes: list[tuple[str, dict]], others: list[str], name: Optional[str]) -> tuple[str, dict]:
    """Return the mesh that is wanted.

    Raises
    ------
    FileError
        If there is none of that name, or there are several and none is named.
    """
    listed = ", ".join(repr(own) for own, _ in meshes)
    if not meshes:
        raise FileError(f"it holds {', '.join(sorted(set(others))) if others else 'no COMPAS object'} and no mesh")
    if name is None and len(meshes) > 1:
        raise FileError(f"it holds {len(meshes)} meshes, {listed}; choose one by its name (--mesh NAME)")
    found = [own for own in meshes if name is None or own[0] == name]
    if not found:
        raise FileError(f"it holds no mesh {name!r}; there is {listed}")
    return found[0]


def _mesh_of(node: dict) -> CGCMesh:
    from compas.datastructures import Mesh

    from ..datastructures import CGCMesh
    from ..datastructures.compas_data import objects_of

    if "dtype" in node and "data" in node:
        thing = objects_of(node)
        return thing if isinstance(thing, CGCMesh) else CGCMesh.from_mesh(thing)
    # COMPAS 0 and 1 keep coordinates that are at their default in the default alone.
    data = node.get("value", node)
    default = data.get("dva") or data.get("default_vertex_attributes") or {}
    keys = list(data["vertex"])
    place = {str(key): i for i, key in enumerate(keys)}
    points = [[{**default, **data["vertex"][key]}[axis] for axis in "xyz"] for key in keys]
    faces = [[place[str(v)] for v in face] for face in data["face"].values()]
    return CGCMesh.from_mesh(Mesh.from_vertices_and_faces(points, faces))


def json_text(surface: PosesProblem) -> str:
    """Return a mesh, or the mesh of a result or problem, as the text of a COMPAS .json file.

    The random identifier that COMPAS gives to every object is left out, so that the same mesh is always the same text.
    """
    from compas.data import DataEncoder

    from ..datastructures import CGCMesh

    mesh = surface if isinstance(surface, CGCMesh) else getattr(surface, "mesh", None) or CGCMesh.from_problem(surface.to_problem())
    own = {key: value for key, value in mesh.__jsondump__().items() if key != "guid"}
    return json.dumps(own, cls=DataEncoder) + "\n"
