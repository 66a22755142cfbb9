"""Requests for a solve: checked before they are queued, kept as bytes, read again by the worker."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from typing import TYPE_CHECKING
from typing import NamedTuple

import numpy as np

from ..errors import Unprocessable
from ..limits import Limits
from .compas_mesh import check_compas_mesh
from .compas_mesh import read_compas_mesh
from .decoding import corner_counts
from .decoding import polygons
from .decoding import read_json
from .decoding import vertex_array
from .options import OPTIONS
from .options import Asked
from .options import read_asked

if TYPE_CHECKING:
    from ...datastructures import CGCMesh
    from ...model.checks import Names
    from ...model.problem import CGCProblem
    from ...solvers.projection import Constraint

__all__ = ["Given", "accept", "given_mesh", "read_accepted"]

MESH = ("vertices", "faces", "roles", "mesh")


class Given(NamedTuple):
    """A mesh as it came, with all that it says itself."""

    problem: CGCProblem
    names: Names  # what the client calls vertices and faces
    name: str
    notes: Sequence[str] = ()
    constraints: tuple[Constraint, ...] = ()


def accept(value: object, limits: Limits) -> tuple[str, bytes]:
    """Check a request.

    Returns
    -------
    str, bytes
        Kind and content, to be kept, for :func:`read_accepted`.

    Raises
    ------
    Unprocessable, TooLarge
        With a sentence that names the field.
    """
    if not isinstance(value, dict):
        raise Unprocessable("the request must be a JSON object with 'vertices' and 'faces', or 'mesh'")
    unknown = sorted(set(value) - set(OPTIONS) - set(MESH))
    if unknown:
        raise Unprocessable(f"there is no field {unknown[0]!r:.60}; there are {', '.join(MESH + OPTIONS)}")
    if not isinstance(value.get("name", ""), str):
        raise Unprocessable("'name' must be a text")
    if value.get("mesh") is not None:
        read_asked(value, None, limits)
        check_compas_mesh(value["mesh"], limits)
        return "compas", json.dumps(value).encode()
    from ...model.checks import dropped_faces

    vertices = vertex_array(value.get("vertices"), limits)
    corners = polygons(value.get("faces"), len(vertices), limits)
    flat, sizes, different = corner_counts(corners)
    if (different < 3).any():
        raise Unprocessable(dropped_faces(np.flatnonzero(different < 3)))
    read_asked(value, len(vertices), limits)
    words = {name: entry for name, entry in value.items() if name not in ("vertices", "faces")}
    content = io.BytesIO()
    np.savez(content, vertices=vertices, corners=flat, sizes=sizes, words=np.frombuffer(json.dumps(words).encode(), dtype=np.uint8))
    return "arrays", content.getvalue()


def read_accepted(kind: str, content: bytes, limits: Limits) -> tuple[Given, Asked]:
    """Return the mesh of an accepted request and what is asked of it.

    Raises
    ------
    Unprocessable
        If COMPAS cannot read its mesh.
    """
    if kind == "compas":
        value = read_json(content, limits)
        return given_mesh(read_compas_mesh(value["mesh"])), read_asked(value, None, limits)
    from ...meshing import triangles_of
    from ...model.checks import Names
    from ...model.problem import CGCProblem

    with np.load(io.BytesIO(content), allow_pickle=False) as file:
        vertices, corners, sizes, words = file["vertices"], file["corners"], file["sizes"], json.loads(file["words"].tobytes())
    # In the worker: large polygons take their time.
    polygon = corners.reshape(-1, 3) if (sizes == 3).all() else np.split(corners, np.cumsum(sizes)[:-1])
    faces, _ = triangles_of(vertices, polygon)
    problem = CGCProblem(vertices, faces)
    names = Names(np.arange(len(vertices)), np.arange(len(faces)))
    return Given(problem, names, words.get("name") or "Mesh"), read_asked(words, len(vertices), limits)


def given_mesh(mesh: CGCMesh, notes: Sequence[str] = ()) -> Given:
    """Return a mesh with what it says itself.

    Raises
    ------
    ProblemError
        If it holds what arrays cannot.
    """
    from ...datastructures.check import problems_of_keys
    from ...io.rhino.constraints import constraints_of
    from ...model.checks import refuse
    from ...model.problem import CGCProblem

    refuse(problems_of_keys(mesh))
    return Given(CGCProblem.from_mesh(mesh), mesh.names(), mesh.name, notes, tuple(constraints_of(mesh)))
