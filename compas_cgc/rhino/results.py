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

from .._version import __version__
from ..discrete import gaussian_curvature
from ..discrete.arrays import FloatArray
from ..files.asked import region_faces
from .archive import read_archive
from .archive import write_archive
from .colours import NO_VALUE
from .colours import largest
from .colours import signed_colours
from .drawing import Drawing
from .layers import RESULT
from .meshes import mesh_from_arrays
from .problem_text import vertex_text
from .units import unit_name
from .units import unit_suffix
from .writing import draw_roles
from .writing import new_archive

if TYPE_CHECKING:
    from ..analysis import SurfaceReport
    from ..result import SolveResult

__all__ = ["write_result"]


def write_result(
    path: Union[str, os.PathLike],
    result: SolveResult,
    source: Union[str, os.PathLike, None] = None,
    settings: Optional[Mapping[str, object]] = None,
    version: Optional[int] = None,
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

    Raises
    ------
    FileError
        If the source cannot be read or the file cannot be written.
    """
    from ..analysis import analyse

    archive = new_archive(result.mesh) if source is None else read_archive(source)
    if version is None:
        version = 8 if source is not None and archive.ArchiveVersion >= 80 else 7
    drawing = Drawing(archive)
    drawing.clear(RESULT)
    analysis = analyse(result.mesh)
    unit = unit_suffix(unit_name(archive.Settings.ModelUnitSystem))
    _draw_surface(drawing, result, analysis)
    draw_roles(drawing, result.mesh, RESULT)
    _draw_maps(drawing, result)
    text = _summary(result, analysis, Path(source).name if source is not None else None, unit)
    _, high, size = _extent(result.mesh.arrays()[0])
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


def _draw_surface(drawing: Drawing, result: SolveResult, analysis: SurfaceReport) -> None:
    """Draw the whole mesh, and one mesh for each region."""
    mesh = result.mesh
    vertices, faces = mesh.arrays()
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
    whole = mesh_from_arrays(vertices, faces)
    drawing.mesh(whole, drawing.attributes(on_mesh, mesh.name, text))
    on_regions = drawing.layer(f"{RESULT}::Regions", (140, 110, 60), visible=False)
    label = region_faces(mesh)
    for region in analysis.regions:
        own = faces[label == region.region]
        used, corners = np.unique(own, return_inverse=True)
        part = whole if len(analysis.regions) == 1 else mesh_from_arrays(vertices[used], corners.reshape(-1, 3))
        figures = {"K": region.target, "K reached": region.total_curvature, "error": region.max_error, "area": region.area}
        notes = {name: repr(value) for name, value in figures.items() if value is not None}
        attributes = drawing.attributes(on_regions, f"region {region.region}", {"region": str(region.region), **notes})
        drawing.mesh(part, attributes)


def _draw_maps(drawing: Drawing, result: SolveResult) -> None:
    """Draw the mesh coloured by curvature and by error, each with a legend."""
    mesh = result.mesh
    vertices, faces = mesh.arrays()
    keys = [v for v in mesh.vertices() if not mesh.is_dummy(v)]
    asked = np.array([mesh.vertex_role(v) == "internal" for v in keys])
    targets = np.array([np.nan if mesh.vertex_target(v) is None else mesh.vertex_target(v) for v in keys], dtype=np.float64)
    K = np.where(asked, gaussian_curvature(vertices, faces), np.nan)
    for name, values, what in (("Curvature", K, "K"), ("Error", K - targets, "K - target")):
        limit = largest(values)
        on = drawing.layer(f"{RESULT}::{name}", (90, 90, 90), visible=False)
        coloured = mesh_from_arrays(vertices, faces, signed_colours(values, limit))
        drawing.mesh(coloured, drawing.attributes(on, name.lower(), {"from": repr(-limit), "to": repr(limit)}))
        low, high, size = _extent(vertices)
        steps = np.linspace(-limit, limit, 5)
        for k, (value, colour) in enumerate(zip(steps, signed_colours(steps, limit).tolist())):
            place = np.array([high[0] + 0.1 * size, low[1] + k * (high[1] - low[1]) / 5, low[2]])
            drawing.dot(f"{what} = {value:.3g}", place, drawing.attributes(on, "legend", colour=tuple(colour)))
        if not asked.all():
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
