"""Solve requests: checked before they are queued, stored as bytes, and converted to a problem once, in the worker."""

from __future__ import annotations

import json
from collections.abc import Mapping
from collections.abc import Sequence
from functools import partial
from typing import Any
from typing import Callable
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...meshing import triangles_of
from ...model.checks import dropped_faces
from ...model.problem import CGCProblem
from ...model.problem import Drawing
from ...solvers.settings import Settings
from ..errors import Unprocessable
from ..limits import Limits
from .compas_mesh import check_compas_mesh
from .compas_mesh import read_compas_mesh
from .decoding import check_size
from .decoding import corner_counts
from .decoding import packed
from .decoding import polygons
from .decoding import read_json
from .decoding import vertex_array
from .last_surface import LastSurface
from .last_surface import check_last
from .last_surface import read_last
from .mesh_files import KINDS
from .mesh_files import read_upload
from .options import OPTIONS
from .options import apply_options
from .options import check_options
from .options import settings_of
from .serialization import unpack_result

__all__ = ["MESH", "READERS", "SOLVED_READERS", "Reader", "SolveRequest", "accept", "solve_request"]

MESH = ("vertices", "faces", "roles", "mesh", "last")


class SolveRequest(NamedTuple):
    """Decoded request for a solve."""

    problem: CGCProblem
    method: str = "auto"
    settings: Optional[Settings] = None
    live: bool = False  # whether to report the surface of every step
    last: Optional[LastSurface] = None  # initial guess from an earlier solve of the same drawing
    notes: Sequence[str] = ()  # changes made to the input


def solve_request(problem: CGCProblem, options: Mapping[str, Any], limits: Limits, notes: Sequence[str] = ()) -> SolveRequest:
    """Return the solve request of a problem and its options.

    Raises
    ------
    Unprocessable, ValueError
        If an option is invalid for this problem.
    """
    settings = settings_of(options, limits)
    return SolveRequest(apply_options(problem, options), options.get("method", "auto"), settings, options.get("live", False), notes=notes)


def accept(value: object, limits: Limits, body: Optional[bytes] = None) -> bytes:
    """Check a request and return it as bytes for the worker.

    Parameters
    ----------
    value
        The request.
    limits
        Those of the server.
    body
        The bytes from which it was parsed.

    Raises
    ------
    Unprocessable, TooLarge
        If a field is missing, invalid or too large.
    """
    if not isinstance(value, dict):
        raise Unprocessable("the request must be a JSON object with 'vertices' and 'faces', or 'mesh'")
    unknown = sorted(set(value) - set(OPTIONS) - set(MESH))
    if unknown:
        raise Unprocessable(f"unknown field {unknown[0]!r:.60}; the fields are {', '.join(MESH + OPTIONS)}")
    if value.get("mesh") is not None:
        check_options(value, None, limits)
        check_last(value.get("last"), None, limits)
        check_compas_mesh(value["mesh"], limits)
        return json.dumps(value).encode()
    vertices = vertex_array(value.get("vertices"), limits)
    faces = polygons(value.get("faces"), len(vertices), limits)
    flat, sizes, different = corner_counts(faces)
    if (different < 3).any():
        raise Unprocessable(dropped_faces(np.flatnonzero(different < 3)))
    check_options(value, len(vertices), limits)
    check_last(value.get("last"), len(vertices), limits)
    if body is not None and isinstance(value["vertices"], dict) and isinstance(value["faces"], dict):
        return body
    # The worker reads packed arrays ten times as fast.
    triangles = packed(flat.reshape(-1, 3)) if (sizes == 3).all() else value["faces"]
    return json.dumps({**value, "vertices": packed(vertices), "faces": triangles}).encode()


def _read_json_request(options: dict, body: bytes, limits: Limits) -> SolveRequest:
    value: Any = read_json(body, limits)
    problem = _problem_of(value, limits) if value.get("mesh") is None else read_compas_mesh(value["mesh"]).to_problem()
    return solve_request(problem, value, limits)._replace(last=read_last(value.get("last"), limits))


def _problem_of(value: dict, limits: Limits) -> CGCProblem:
    """Return the problem of vertices and polygons. Runs in the worker, as triangulating large polygons is slow."""
    vertices = vertex_array(value["vertices"], limits)
    faces, _ = triangles_of(vertices, polygons(value["faces"], len(vertices), limits))
    return CGCProblem(vertices, faces, drawing=Drawing("Mesh"))


def _read_file(kind: str, options: dict, body: bytes, limits: Limits, result: bool = False) -> SolveRequest:
    read = read_upload(kind, body, result, options.get("edge_length"))
    problem = read.checked()
    check_size(len(problem.vertices), len(problem.faces), limits)
    return solve_request(problem, options, limits, read.notes)


def _read_result(options: dict, body: bytes, limits: Limits) -> SolveRequest:
    return solve_request(unpack_result(body)[0].problem, options, limits)


# Functions by format of the body that convert (options, body, limits) to a request; importable in the workers.
Reader = Callable[[dict, bytes, Limits], SolveRequest]
READERS: dict[str, Reader] = {
    "json": _read_json_request,
    **{kind: partial(_read_file, kind) for kind in KINDS},
    "result": _read_result,
}
# The same for solved surfaces.
SOLVED_READERS: dict[str, Reader] = {**READERS, **{kind: partial(_read_file, kind, result=True) for kind in KINDS}}
