"""Write a solved surface: the input file as it was, and the result on layers of its own."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Optional
from typing import Union

import numpy as np
import rhino3dm

from ..._version import __version__
from ...discrete import gaussian_curvature
from ...discrete.arrays import FloatArray
from ..asked import Asked
from ..asked import asked_of
from .archive import read_archive
from .archive import write_archive
from .colours import NO_VALUE
from .colours import largest
from .colours import signed_colours
from .drawing import Drawing
from .layers import RESULT
from .meshes import coloured
from .meshes import mesh_from_arrays
from .problem_text import vertex_text
from .units import unit_name
from .units import unit_suffix
from .write import draw_roles
from .write import new_archive

if TYPE_CHECKING:
    from ...analysis import SurfaceReport
    from ...model.result import SolveResult

__all__ = ["write_result"]


def write_result(
    path: Union[str, os.PathLike],
    result: SolveResult,
    source: Union[str, os.PathLike, None] = None,
    settings: Optional[Mapping[str, object]] = None,
    version: Optional[int] = None,
    analysis: Optional[SurfaceReport] = None,
) -> None:
    """Write a result as a .3dm file, beside what the input file holds.

    Parameters
    ----------
    path
        The .3dm file, which may be `source` itself; an older one is replaced when the new
        one is complete.
    result
        What a solve returned.
    source
        The .3dm file that the problem was read from. All that is in it stays, but for an
        earlier result. Without one the result is written alone.
    settings
        Settings of the solve, to be noted in the file.
    version
        7 or 8. Default: 8 for a source of Rhino 8, else 7.
    analysis
        The report on the surface. Default: made here.

    Raises
    ------
    FileError
        If the source cannot be read or the file cannot be written.
    """
    from ...analysis import analyse

    mesh = asked_of(result.mesh)
    own = result.mesh.attributes
    archive = new_archive(mesh.vertices, own.get("units"), own.get("tolerance")) if source is None else read_archive(source)
    if version is None:
        version = 8 if source is not None and archive.ArchiveVersion >= 80 else 7
    drawing = Drawing(archive)
    drawing.clear(RESULT)
    analysis = analysis or analyse(result.mesh)
    unit = unit_suffix(unit_name(archive.Settings.ModelUnitSystem))
    whole = mesh_from_arrays(mesh.vertices, mesh.faces)
    _draw_surface(drawing, mesh, whole, result, analysis)
    draw_roles(drawing, mesh, RESULT)
    _draw_maps(drawing, mesh, whole)
    text = _summary(result, analysis, Path(source).name if source is not None else None, unit)
    _, high, size = _extent(mesh.vertices)
    on_report = drawing.layer(f"{RESULT}::Report", (60, 60, 60))
    drawing.dot(text, high + [0.0, 0.1 * size, 0.0], drawing.attributes(on_report, "report"))
    record = {
        "version": __version__,
        "method": result.method,
        "status": result.status,
        "message": result.message,
        "steps": result.iterations,
        "seconds": result.seconds,
        "max_error": result.max_error,
        "units": unit_name(archive.Settings.ModelUnitSystem),
        **analysis.to_dict(),
    }
    drawing.document_text(
        [
            ("compas_cgc.version", __version__),
            ("compas_cgc.settings", json.dumps(dict(settings or {}))),
            ("compas_cgc.result", json.dumps(record)),
            ("compas_cgc.report", text),
        ]
    )
    write_archive(archive, path, version)


def _draw_surface(drawing: Drawing, mesh: Asked, whole: rhino3dm.Mesh, result: SolveResult, analysis: SurfaceReport) -> None:
    """Draw the whole mesh, and one mesh for each region."""
    targets = {region.target for region in analysis.regions if region.asked}
    text = {
        "status": result.status,
        "max error": repr(result.max_error),
        "method": result.method,
        "version": __version__,
        **({"target": repr(targets.copy().pop())} if len(targets) == 1 and None not in targets else {}),
        **vertex_text(mesh),
    }
    on_mesh = drawing.layer(f"{RESULT}::Mesh", (120, 120, 120))
    drawing.mesh(whole, drawing.attributes(on_mesh, mesh.name, text))
    on_regions = drawing.layer(f"{RESULT}::Regions", (140, 110, 60), visible=False)
    for region in analysis.regions:
        used, corners = np.unique(mesh.faces[mesh.regions == region.region], return_inverse=True)
        part = whole if len(analysis.regions) == 1 else mesh_from_arrays(mesh.vertices[used], corners.reshape(-1, 3))
        figures = {"K": region.target, "K reached": region.total_curvature, "error": region.max_error, "area": region.area}
        notes = {name: repr(value) for name, value in figures.items() if value is not None}
        attributes = drawing.attributes(on_regions, f"region {region.region}", {"region": str(region.region), **notes})
        drawing.mesh(part, attributes)


def _draw_maps(drawing: Drawing, mesh: Asked, whole: rhino3dm.Mesh) -> None:
    """Draw the mesh coloured by curvature and by error, each with a legend."""
    K = np.where(mesh.asked, gaussian_curvature(mesh.vertices, mesh.faces), np.nan)
    low, high, size = _extent(mesh.vertices)
    for name, values, what in (("Curvature", K, "K"), ("Error", K - mesh.targets, "K - target")):
        limit = largest(values)
        on = drawing.layer(f"{RESULT}::{name}", (90, 90, 90), visible=False)
        attributes = drawing.attributes(on, name.lower(), {"from": repr(-limit), "to": repr(limit)})
        drawing.mesh(coloured(whole, signed_colours(values, limit)), attributes)
        steps = np.linspace(-limit, limit, 5)
        for k, (value, colour) in enumerate(zip(steps, signed_colours(steps, limit).tolist())):
            place = np.array([high[0] + 0.1 * size, low[1] + k * (high[1] - low[1]) / 5, low[2]])
            drawing.dot(f"{what} = {value:.3g}", place, drawing.attributes(on, "legend", colour=tuple(colour)))
        if not mesh.asked.all():
            place = np.array([high[0] + 0.1 * size, high[1], low[2]])
            drawing.dot("not asked for", place, drawing.attributes(on, "legend", colour=NO_VALUE))


def _extent(vertices: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    return low, high, float(np.linalg.norm(high - low))


def _summary(result: SolveResult, analysis: SurfaceReport, source: Optional[str], unit: str) -> str:
    """Return the report that is put into the drawing."""
    where = f" of {source}" if source else ""
    inverse = f" 1/{unit.strip()}²" if unit else ""
    head = f"compas_cgc {__version__}: result{where}\n{result.status}: {result.message}\nlargest error of K {result.max_error:.3g}{inverse}"
    return f"{head}\n{analysis}"
