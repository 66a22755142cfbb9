"""Encoding of a result in the format that a client requests."""

from __future__ import annotations

import json
import math
from typing import Callable

import numpy as np

from ...datastructures import SolveResult
from ...io.compas_json import json_text
from ...meshing import crease_paths
from ...model.roles import ROLES
from ..errors import Unprocessable
from .builds import BUILD_FORMATS
from .builds import build_file
from .builds import is_build
from .decoding import packed
from .mesh_files import KINDS
from .mesh_files import SURFACES
from .mesh_files import file_bytes
from .rhino_mesh import mesh_text
from .serialization import WORDS
from .serialization import unpack_result

__all__ = ["FORMATS", "SHOWN", "encoded", "merged_into", "moved"]

SHOWN = ("arrays", "packed", "compas", "hops")  # returned as JSON; the other formats are files to download
OF_A_SOLVE = {**dict.fromkeys(SHOWN, "application/json"), **KINDS, **SURFACES}
FORMATS = {**OF_A_SOLVE, **BUILD_FORMATS}


def encoded(name: str, content: bytes) -> bytes:
    """Return a packed result in a format.

    Parameters
    ----------
    name
        One of :data:`FORMATS`.
    content
        A result from :func:`compas_cgc.server.api.serialization.pack_result`, or the archive of a build.

    Raises
    ------
    Unprocessable
        If the job has no result in this format.
    """
    if is_build(content):
        return build_file(content, name)
    if name not in OF_A_SOLVE:
        raise Unprocessable(f"a solve has no result in the format {name}; its formats are {', '.join(OF_A_SOLVE)}")
    result, report = unpack_result(content)
    if name in ("arrays", "packed"):
        return _arrays(result, report, name == "packed")
    if name == "compas":
        return json_text(result.mesh).encode("utf-8")
    if name == "hops":
        return mesh_text(result.vertices, result.faces).encode()
    return file_bytes(name, result)


def moved(content: bytes) -> bytes:
    """Return a result without faces, roles and creases, which the client already has, as packed JSON on one line.

    The faces are included where edges were flipped.
    """
    result, report = unpack_result(content)
    return _arrays(result, report, in_bytes=True, mesh=result.turned > 0)


def merged_into(source: bytes, content: bytes) -> bytes:
    """Return the bytes of a .3dm file with a packed result merged into it."""
    return file_bytes("3dm", unpack_result(content)[0], source)


def _arrays(result: SolveResult, report: dict, in_bytes: bool, mesh: bool = True) -> bytes:
    """Return a result as JSON, with arrays as lists (null for NaN) or packed.

    Built directly from the arrays, which takes a third of the time of a COMPAS mesh.
    """
    rows: Callable = packed if in_bytes else np.ndarray.tolist
    column: Callable = packed if in_bytes else _column
    problem = result.problem
    known = {
        "faces": lambda: rows(problem.faces),
        "roles": lambda: np.array(ROLES, dtype=object)[problem.roles].tolist(),
        "creases": lambda: crease_paths(map(tuple, problem.names.vertices[problem.creases].tolist())),
    }
    body = {
        **{word: _plain(getattr(result, word)) for word in WORDS},
        "vertices": rows(problem.vertices),
        **{name: value() for name, value in known.items() if mesh},
        "turned": result.turned,
        "targets": column(problem.targets),
        "curvature": column(result.curvature),
        "history": _plain(result.history.to_dict()),
        "report": _plain(report),
    }
    return json.dumps(body, ensure_ascii=False, allow_nan=False).encode("utf-8")


def _column(values: np.ndarray) -> list:
    """Return numbers as a list, with None for NaN."""
    return [x if math.isfinite(x) else None for x in values.tolist()]


def _plain(value: object) -> object:
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value
