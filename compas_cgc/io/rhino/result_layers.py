"""Writing of a result to separate layers of the input file."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING
from typing import Optional
from typing import Union

import numpy as np

from ..._version import __version__
from ...analysis import SurfaceReport
from ...analysis import analyse
from ...discrete.arrays import FloatArray
from ...errors import names_what_was_meant
from ...model.lengths import unit_suffix
from ...model.measures import measured_curvature
from ...model.problem import CGCProblem
from .archive import read_archive
from .archive import write_archive
from .colours import NO_VALUE
from .colours import largest
from .colours import signed_colours
from .layers import NURBS
from .layers import RESULT
from .meshes import coloured
from .meshes import mesh_from_arrays
from .nurbs_layer import draw_nurbs
from .units import unit_name
from .write import LayerWriter
from .write import draw_problem
from .write import new_archive

if TYPE_CHECKING:
    from ...datastructures import SolveResult
from ._types import Mesh

__all__ = ["draw_result", "write_result"]

AMBER = (230, 150, 20)


@names_what_was_meant()
def write_result(
    path: Union[str, os.PathLike],
    result: SolveResult,
    source: Union[str, os.PathLike, None] = None,
    version: Optional[int] = None,
    analysis: Optional[SurfaceReport] = None,
    nurbs: bool = False,
) -> list[str]:
    """Write a result as a .3dm file, in addition to the contents of the input file.

    Parameters
    ----------
    path
        The .3dm file, which may be `source` itself; an existing file is replaced when the new
        one is complete.
    result
        Result of a solve.
    source
        The .3dm file from which the problem was read. Its contents are kept, except for an
        earlier result. Default: write the result only.
    version
        7 or 8. Default: 8 if the source is a Rhino 8 file, else 7.
    analysis
        Report on the surface. Default: computed here.

    nurbs
        Whether to fit a NURBS surface to each region, on the layer ``CGC::NURBS``.

    Returns
    -------
    list of str
        Notes on the NURBS surfaces.

    Raises
    ------
    FileError
        If the source cannot be read or the file cannot be written.

    Examples
    --------
    >>> import compas_cgc, os, tempfile
    >>> result = compas_cgc.solve(compas_cgc.read(compas_cgc.get("cushion.3dm")))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     notes = write_result(os.path.join(folder, "roof.3dm"), result)
    ...     print(os.listdir(folder))
    ['roof.3dm']
    """
    problem = result.problem
    archive = new_archive(problem) if source is None else read_archive(source)
    if version is None:
        version = 8 if source is not None and archive.ArchiveVersion >= 80 else 7
    writer = LayerWriter(archive)
    notes = draw_result(writer, result, analysis or analyse(result), None if source is None else Path(source).name, nurbs)
    write_archive(archive, path, version)
    return notes


def draw_result(
    writer: LayerWriter, result: SolveResult, report: SurfaceReport, source: Optional[str] = None, nurbs: bool = False
) -> list[str]:
    """Draw a result with its report in the place of an earlier one; return notes on the NURBS surfaces."""
    problem, archive = result.problem, writer.archive
    for earlier in (RESULT, NURBS):
        writer.clear(earlier)
    whole = mesh_from_arrays(problem.vertices, problem.faces)
    draw_problem(writer, problem, RESULT, whole, _outcome(result, report))
    _draw_regions(writer, problem, whole, report)
    _draw_maps(writer, problem, whole)
    _draw_rough_places(writer, problem, report)
    units = unit_name(archive.Settings.ModelUnitSystem)
    notes = draw_nurbs(writer, problem, unit_suffix(units)) if nurbs else []
    head, text = _summaries(result, report, source, unit_suffix(units))
    _, high, size = _extent(problem.vertices)
    on_report = writer.layer(f"{RESULT}::Report", (60, 60, 60))
    writer.dot(head, high + [0.0, 0.1 * size, 0.0], writer.attributes(on_report, "report", {"report": text}))
    record = {"version": __version__, "units": units, **result.to_dict(history=False), **report.to_dict()}
    writer.document_text(
        [
            ("compas_cgc.version", __version__),
            ("compas_cgc.settings", json.dumps(record["settings"] or {})),
            ("compas_cgc.result", json.dumps(record)),
            ("compas_cgc.report", text),
        ]
    )
    return notes


def _outcome(result: SolveResult, report: SurfaceReport) -> dict[str, str]:
    """Return user text of the mesh: outcome of the solve, and the target if it is constant."""
    targets = {region.target for region in report.regions if region.asked}
    one = {"target": repr(targets.pop())} if len(targets) == 1 and None not in targets else {}
    return {
        "verdict": str(report.verdict),
        "status": result.status,
        "max error": repr(report.max_error),
        "method": result.method,
        "measure": result.measure,
        "version": __version__,
        **one,
    }


def _draw_regions(writer: LayerWriter, problem: CGCProblem, whole: Mesh, report: SurfaceReport) -> None:
    """Draw one mesh per region, with its data as user text."""
    on_regions = writer.layer(f"{RESULT}::Regions", (140, 110, 60), visible=False)
    label = problem.regions()
    for region in report.regions:
        used, corners = np.unique(problem.faces[label == region.region], return_inverse=True)
        part = whole if len(report.regions) == 1 else mesh_from_arrays(problem.vertices[used], corners.reshape(-1, 3))
        figures = {"K": region.target, "K reached": region.total_curvature, "error": region.max_error, "area": region.area}
        notes = {name: repr(value) for name, value in figures.items() if value is not None}
        law = {"law": str(problem.laws[region.region])} if region.region in problem.laws else {}
        attributes = writer.attributes(on_regions, f"region {region.region}", {"region": str(region.region), **notes, **law})
        writer.mesh(part, attributes)


def _draw_maps(writer: LayerWriter, problem: CGCProblem, whole: Mesh) -> None:
    """Draw the mesh coloured by curvature and by error, each with a legend."""
    K = measured_curvature(problem)
    low, high, size = _extent(problem.vertices)
    for name, values, what in (("Curvature", K, "K"), ("Error", K - problem.targets, "K - target")):
        limit = largest(values)
        on = writer.layer(f"{RESULT}::{name}", (90, 90, 90), visible=False)
        attributes = writer.attributes(on, name.lower(), {"from": repr(-limit), "to": repr(limit)})
        writer.mesh(coloured(whole, signed_colours(values, limit)), attributes)
        steps = np.linspace(-limit, limit, 5)
        for k, (value, colour) in enumerate(zip(steps, signed_colours(steps, limit).tolist())):
            place = np.array([high[0] + 0.1 * size, low[1] + k * (high[1] - low[1]) / 5, low[2]])
            writer.dot(f"{what} = {value:.3g}", place, writer.attributes(on, "legend", colour=tuple(colour)))
        if np.isnan(values).any():
            place = np.array([high[0] + 0.1 * size, high[1], low[2]])
            writer.dot("no value", place, writer.attributes(on, "legend", colour=NO_VALUE))


def _draw_rough_places(writer: LayerWriter, problem: CGCProblem, report: SurfaceReport) -> None:
    """Draw a point at every vertex where the surface is rough."""
    if report.verdict.places:
        on = writer.layer(f"{RESULT}::Rough", AMBER)
        writer.cloud(problem.vertices[report.verdict.places], writer.attributes(on, "rough", {"verdict": str(report.verdict)}))


def _extent(vertices: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    return low, high, float(np.linalg.norm(high - low))


def _summaries(result: SolveResult, analysis: SurfaceReport, source: Optional[str], unit: str) -> tuple[str, str]:
    """Return the result in three short lines, for a text dot, and the whole report."""
    error = f"largest error of K {analysis.max_error:.3g}" + (f" 1/{unit.strip()}²" if unit else "")
    verdict = "fair" if analysis.verdict.fair else "rough"
    head = f"{source or 'result'}: {verdict}, {result.status}\n{error}\nfull report: user text of this dot"
    where = f" of {source}" if source else ""
    return head, f"compas_cgc {__version__}: result{where}\n{result.status}: {result.message}\n{error}\n{analysis}"
