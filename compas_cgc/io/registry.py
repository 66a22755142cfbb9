"""One door for meshes of all formats."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Optional
from typing import Union

from ..errors import FileError
from .asked import asked_of
from .cleanup import tidied
from .compas_json import json_text
from .compas_json import read_json
from .obj import obj_text
from .obj import read_obj
from .off import off_text
from .off import read_off
from .ply import ply_text
from .ply import read_ply
from .stl import read_stl
from .stl import stl_text
from .written import written

if TYPE_CHECKING:
    from ..analysis import SurfaceReport
    from ..datastructures import CGCMesh
    from ..model.result import SolveResult

__all__ = ["SUFFIXES", "read_mesh", "write_mesh"]

_READERS = {".obj": read_obj, ".off": read_off, ".ply": read_ply, ".stl": read_stl}
_WRITERS = {".obj": obj_text, ".off": off_text, ".ply": ply_text, ".stl": stl_text}
SUFFIXES = (".3dm", ".json", *sorted(_WRITERS))


def read_mesh(
    path: Union[str, os.PathLike],
    layers: Optional[Mapping[str, object]] = None,
    crease: str = "trace",
    tolerance: Optional[float] = None,
    edge_length: Optional[float] = None,
) -> tuple[CGCMesh, list[str]]:
    """Read a mesh with the supports, creases and targets that the file holds.

    .3dm and COMPAS .json hold all of them, .ply all but single strategies, .obj all but
    targets that vary inside of a region; .off and .stl hold none. Meshes are welded,
    triangulated and oriented where they need it.

    Parameters
    ----------
    path
        A .3dm, .json, .obj, .off, .ply or .stl file.
    layers, crease, tolerance, edge_length
        For .3dm, see :func:`compas_cgc.io.rhino.read_model`.

    Returns
    -------
    mesh, notes
        The notes say in sentences what was found and done.

    Raises
    ------
    FileError
        If the file cannot be read.
    ProblemError
        If supports, creases or targets of a .3dm do not fit the mesh.
    """
    source = Path(path)
    suffix = _suffix(source)
    if suffix == ".3dm":
        from .rhino import read_model

        model = read_model(source, layers, crease, tolerance, edge_length)
        return model.to_cgcmesh(), list(model.notes)
    if suffix == ".json":
        return read_json(source), []
    found = _READERS[suffix](source)
    if not len(found.vertices) or not len(found.faces):
        raise FileError(f"{path} holds no mesh; give one with vertices and faces")
    return tidied(found, source)


def write_mesh(
    path: Union[str, os.PathLike],
    mesh: CGCMesh,
    result: Optional[SolveResult] = None,
    source: Union[str, os.PathLike, None] = None,
    settings: Optional[Mapping[str, object]] = None,
    version: Optional[int] = None,
    analysis: Optional[SurfaceReport] = None,
) -> None:
    """Write a mesh in the format of the suffix, whole or not at all; every digit is kept.

    Parameters
    ----------
    path
        A .3dm, .json, .obj, .off, .ply or .stl file; an older one is replaced when the
        new one is complete.
    mesh
        The mesh; a dummy mesh is left out of all formats but .json.
    result
        The result of a solve, whose mesh is written; a .3dm shows all of it.
    source
        The file that the problem was read from; if both are .3dm, all that was in it
        is kept.
    settings
        Settings of the solve, noted in a .3dm.
    version
        Of a .3dm: 7 or 8.
    analysis
        The report on the result, shown in a .3dm. Default: made here.

    Raises
    ------
    FileError
        If it cannot be written.
    """
    target = Path(path)
    suffix = _suffix(target)
    if suffix == ".3dm":
        from .rhino import write_model
        from .rhino import write_result

        if result is None:
            write_model(target, mesh, version or 7)
        else:
            write_result(target, result, source if source is not None and _is_3dm(source) else None, settings, version, analysis)
        return
    solved = mesh if result is None else result.mesh
    text = json_text(solved) if suffix == ".json" else _WRITERS[suffix](asked_of(solved))
    with written(target) as beside:
        beside.write_bytes(text.encode("utf-8"))


def _suffix(path: Path) -> str:
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise FileError(f"{path}: files of the kind {suffix or 'without suffix'!r} are not known; use {', '.join(SUFFIXES)}")
    return suffix


def _is_3dm(path: Union[str, os.PathLike]) -> bool:
    return Path(path).suffix.lower() == ".3dm"
