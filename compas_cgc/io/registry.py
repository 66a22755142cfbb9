"""Formats by suffix: one reader and one writer for meshes in all formats."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Any
from typing import Optional
from typing import Union
from typing import cast

from .._atomic_write import replacing
from ..errors import FileError
from ..errors import names_what_was_meant
from ..meshing.cleanup import Omission
from ..model.manifold import as_manifold
from ..model.problem import PosesProblem
from ..model.problem import problem_of
from ..model.units import GivenLength
from ..model.units import within
from .compas_json import json_text
from .compas_json import read_json
from .cursor import guarded
from .formats import FORMATS
from .formats import READ_SUFFIXES
from .formats import WRITTEN_SUFFIXES
from .formats import listed
from .occt import opencascade
from .reading import ReadProblem

if TYPE_CHECKING:
    from ..analysis import SurfaceReport
    from ..datastructures import CGCMesh
    from ..datastructures import SolveResult

__all__ = ["known_suffix", "read", "read_mesh", "read_problem", "write"]

PathLike = Union[str, "os.PathLike[str]"]


@names_what_was_meant()
def read_problem(
    path: PathLike,
    *,
    layers: Optional[Mapping[str, object]] = None,
    crease: str = "trace",
    tolerance: Optional[GivenLength] = None,
    edge_length: Optional[GivenLength] = None,
    mesh: Optional[str] = None,
    result: bool = False,
    manifold: bool = False,
) -> ReadProblem:
    """Read a mesh with its supports, creases, targets and goals.

    :data:`compas_cgc.io.FORMATS` lists what each format holds. Meshes are welded, triangulated and oriented if necessary.

    Parameters
    ----------
    path
        A file in one of the formats of :data:`compas_cgc.io.FORMATS`.
    layers, crease, edge_length
        For .3dm and .dxf, see :func:`compas_cgc.io.rhino.read_3dm`.
    tolerance
        Distance within which points are merged [L]. Default: that of a .3dm file, small gaps between the curves of a .dxf file,
        and only coincident points in other formats.
    mesh
        Name of the mesh in a COMPAS .json file that holds several.
    result
        Whether to read the result in a .3dm file instead of the drawing.
    manifold
        Whether to give parts that meet in a point, or at an edge of more than two faces, vertices of their own.

    Returns
    -------
    ReadProblem
        The problem, notes on the contents, and errors in them.

    Raises
    ------
    FileError
        If the file cannot be read.

    Examples
    --------
    >>> import compas_cgc
    >>> found = read_problem(compas_cgc.get("nine_regions.3dm"))
    >>> found.checked().region_targets()[4]
    0.04
    """
    source = Path(path)
    suffix = _suffix_among(source, READ_SUFFIXES)
    with guarded(source):
        if suffix == ".3dm":
            from .rhino.read import read_3dm

            found = read_3dm(source, layers=layers, crease=crease, tolerance=tolerance, edge_length=edge_length, result=result)
        elif suffix == ".json":
            drawn, notes = read_json(source, mesh)
            found = ReadProblem(drawn.to_problem(), tuple(notes))
        elif suffix == ".dxf":
            from .plans.problem import read_dxf

            found = read_dxf(source, layers=layers, crease=crease, tolerance=tolerance, edge_length=edge_length)
        else:
            found = _function("read_{}", suffix)(source, within(tolerance, None) or 0.0)
        return _split(found) if manifold else found


def _split(found: ReadProblem) -> ReadProblem:
    problem = as_manifold(found.problem)
    added = len(problem.vertices) - len(found.problem.vertices)
    note = [f"{added} {'vertices were' if added > 1 else 'vertex was'} added where several parts of the mesh met"] if added else []
    return found._replace(problem=problem, notes=(*found.notes, *note))


@names_what_was_meant()
def read_mesh(
    path: PathLike,
    *,
    layers: Optional[Mapping[str, object]] = None,
    crease: str = "trace",
    tolerance: Optional[GivenLength] = None,
    edge_length: Optional[GivenLength] = None,
    mesh: Optional[str] = None,
    result: bool = False,
    manifold: bool = False,
) -> tuple[CGCMesh, list[str]]:
    """Read a mesh and notes on its contents, see :func:`read_problem`.

    Parameters
    ----------
    path
        A file in one of the formats of :data:`compas_cgc.io.FORMATS`.
    layers, crease, tolerance, edge_length, mesh, result, manifold
        See :func:`read_problem`.

    Returns
    -------
    mesh, notes
        The mesh, and notes on the contents and on changes made to them.

    Raises
    ------
    FileError
        If the file cannot be read.
    ProblemError
        If supports, creases, targets or goals of a .3dm do not fit the mesh.

    Examples
    --------
    >>> import compas_cgc
    >>> mesh, notes = read_mesh(compas_cgc.get("nine_regions.3dm"))
    >>> notes[0]
    '225 quads and polygons were split into triangles'
    """
    from ..datastructures import CGCMesh

    if _suffix_among(path, READ_SUFFIXES) == ".json" and not manifold:
        return read_json(Path(path), mesh)
    options: dict[str, Any] = {"layers": layers, "crease": crease, "tolerance": tolerance, "edge_length": edge_length, "mesh": mesh}
    found = read_problem(path, **options, result=result, manifold=manifold)
    return CGCMesh.from_problem(found.checked()), list(found.notes)


@names_what_was_meant()
def read(
    path: PathLike,
    *,
    layers: Optional[Mapping[str, object]] = None,
    crease: str = "trace",
    tolerance: Optional[GivenLength] = None,
    edge_length: Optional[GivenLength] = None,
    mesh: Optional[str] = None,
    result: bool = False,
    manifold: bool = False,
) -> CGCMesh:
    """Read a mesh with supports, creases, targets and goals, see :func:`read_mesh`.

    A warning names what was left out.

    Parameters
    ----------
    path
        A file in one of the formats of :data:`compas_cgc.io.FORMATS`.
    layers, crease, tolerance, edge_length, mesh, result, manifold
        See :func:`read_problem`.

    Returns
    -------
    CGCMesh
        The mesh with the supports, creases, targets and goals that the format holds.

    Examples
    --------
    >>> import compas_cgc
    >>> mesh = compas_cgc.read(compas_cgc.get("nine_regions.3dm"))
    >>> mesh.number_of_faces(), mesh.region_target(4)
    (450, 0.04)
    """
    options: dict[str, Any] = {"layers": layers, "crease": crease, "tolerance": tolerance, "edge_length": edge_length, "mesh": mesh}
    made, notes = read_mesh(path, **options, result=result, manifold=manifold)
    for note in notes:
        if isinstance(note, Omission):
            warnings.warn(f"{os.fspath(path)}: {note}", stacklevel=3)
    return made


@names_what_was_meant()
def write(
    path: PathLike,
    surface: Union[SolveResult, PosesProblem],
    *,
    source: Optional[PathLike] = None,
    version: Optional[int] = None,
    analysis: Optional[SurfaceReport] = None,
    nurbs: bool = False,
) -> list[str]:
    """Write a surface in the format of the suffix, atomically and in full precision.

    Parameters
    ----------
    path
        A file in one of the formats of :data:`compas_cgc.io.FORMATS`; an existing file is
        replaced when the new one is complete.
    surface
        A result, mesh or problem. Dummy vertices are written to .json only. A .3dm file also
        shows curvature, errors and regions of a result.
    source
        File from which the problem of a result was read. If both are .3dm files, its contents
        are kept.
    version
        Version of a .3dm file: 7 or 8.
    analysis
        Report on a result, shown in a .3dm file. Default: computed here.
    nurbs
        Whether to fit a NURBS surface to each region of a result, on the layer ``CGC::NURBS`` of a .3dm file.

    Returns
    -------
    list of str
        Notes on the NURBS surfaces, and on what the format does not hold.

    Raises
    ------
    FileError
        If the file cannot be written.
    MeshError
        If the smooth surfaces of a STEP file do not meet their tolerances.

    Examples
    --------
    >>> import compas_cgc, os, tempfile
    >>> mesh = compas_cgc.CGCMesh.from_meshgrid(dx=4.0, nx=4)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     notes = compas_cgc.write(os.path.join(folder, "plan.obj"), mesh)
    ...     print(os.listdir(folder))
    ['plan.obj']
    """
    suffix = known_suffix(path)
    target = Path(path)
    if suffix == ".3dm":
        return _write_3dm(target, surface, source, version, analysis, nurbs)
    notes = []
    if FORMATS[suffix].surfaces:
        return _write_step(target, surface)
    if suffix == ".json":
        text = json_text(surface)
    else:
        problem = problem_of(surface, "or a result is written").without_dummies()
        text = _function("{}_text", suffix)(problem)
        if problem.laws:
            notes.append(f"the laws of regions {listed(map(str, problem.laws))} are not in {target.name}; .3dm and .json files hold laws")
    with replacing(target) as temporary:
        temporary.write_bytes(text.encode("utf-8"))
    return notes


def _write_step(target: Path, surface: Union[SolveResult, PosesProblem]) -> list[str]:
    from .step import step_bytes

    content, notes = step_bytes(problem_of(surface, "or a result is written").without_dummies())
    with replacing(target) as temporary:
        temporary.write_bytes(content)
    return notes


def _function(name: str, suffix: str) -> Callable:
    """Return a function of the module of a text format, such as ``read_obj``."""
    kind = suffix[1:]
    return getattr(import_module(f".{kind}", __package__), name.format(kind))


def _write_3dm(
    target: Path,
    surface: Union[SolveResult, PosesProblem],
    source: Optional[PathLike],
    version: Optional[int],
    analysis: Optional[SurfaceReport],
    nurbs: bool,
) -> list[str]:
    from .rhino.result_layers import write_result
    from .rhino.write import write_problem

    kept = source if source is not None and Path(source).suffix.lower() == ".3dm" else None
    # A result also holds its status and message.
    if hasattr(surface, "status"):
        return write_result(target, cast("SolveResult", surface), source=kept, version=version, analysis=analysis, nurbs=nurbs)
    write_problem(target, surface, version or 7)
    return []


@names_what_was_meant()
def known_suffix(path: Union[str, os.PathLike[str]]) -> str:
    """Return the suffix of a file that can be written, in lower case.

    Parameters
    ----------
    path
        Path of a file, which need not exist.

    Returns
    -------
    str
        The suffix, such as ``".3dm"``.

    Raises
    ------
    FileError
        If the format is not supported, or the package that writes it is not installed.

    Examples
    --------
    >>> known_suffix("Roof.3DM")
    '.3dm'
    """
    suffix = _suffix_among(path, WRITTEN_SUFFIXES)
    if suffix == ".3dm":
        from .rhino.archive import rhino3dm_module

        rhino3dm_module()
    elif FORMATS[suffix].surfaces:
        opencascade()
    return suffix


def _suffix_among(path: PathLike, suffixes: tuple[str, ...]) -> str:
    if not isinstance(path, (str, os.PathLike)):
        raise FileError(f"the first argument must be a path, as in write('roof.3dm', mesh), not a {type(path).__name__}")
    suffix = Path(path).suffix.lower()
    if suffix not in suffixes and Path(path).is_dir():
        raise FileError(f"{path} is a folder; give the path of a file in it")
    if suffix not in suffixes:
        raise FileError(f"{path}: the format {suffix or 'without suffix'!r} is not supported; use {listed(suffixes)}")
    return suffix
