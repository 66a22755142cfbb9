"""Writing of rationalised designs: solved surface, panels by mould, seams and distance from the design."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING
from typing import NamedTuple
from typing import Optional
from typing import Union

import numpy as np

from ...analysis import analyse
from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from .archive import read_archive
from .archive import write_archive
from .colours import largest
from .colours import signed_colours
from .layers import RATIONALISED
from .meshes import coloured
from .meshes import mesh_from_arrays
from .result_layers import draw_result
from .write import LayerWriter
from .write import new_archive

if TYPE_CHECKING:
    from ...datastructures import SolveResult

__all__ = ["RATIONALISED", "PanelClasses", "mould_colour", "mould_name", "write_panels"]

_COLOURS = (
    (232, 196, 143),
    (127, 166, 173),
    (207, 132, 101),
    (167, 181, 139),
    (141, 147, 181),
    (217, 165, 160),
    (183, 165, 143),
    (111, 143, 134),
)


class PanelClasses(NamedTuple):
    """The panels of a surface and their moulds."""

    panels: IntArray  # (m,) panel of every face
    classes: IntArray  # (p,) mould of every panel
    curvatures: FloatArray  # (k,) K of the moulds [1/L^2]
    distances: FloatArray  # (n,) signed distance of every vertex from the design [L]


def write_panels(
    path: Union[str, os.PathLike],
    result: SolveResult,
    classes: PanelClasses,
    texts: Optional[Mapping[str, str]] = None,
    source: Union[str, os.PathLike, None] = None,
    nurbs: bool = False,
) -> list[str]:
    """Write a solved surface with its panels on the sublayers of ``CGC Rationalised``, in addition to the contents of a file.

    ========  ===================================================================================
    Moulds    one sublayer per mould, with one mesh per panel in its colour
    Seams     the seams as polylines
    Distance  the surface coloured by its signed distance from the design, with a legend
    ========  ===================================================================================

    Parameters
    ----------
    path
        The .3dm file; an existing file is replaced when the new one is complete.
    result
        The solved surface.
    classes
        Its panels and their moulds.
    texts
        Document user text, such as the report.
    source
        The .3dm file of the design, whose contents are kept.
    nurbs
        Whether to draw a NURBS surface for each panel, whose sides coincide with those of its neighbours.

    Returns
    -------
    list[str]
        Notes on the NURBS surfaces.

    Raises
    ------
    FileError
        If the source cannot be read or the file cannot be written.
    """
    problem = result.problem
    archive = new_archive(problem) if source is None else read_archive(source)
    writer = LayerWriter(archive)
    notes = draw_result(writer, result, analyse(result), None if source is None else os.path.basename(source), nurbs)
    writer.clear(RATIONALISED)
    order = np.argsort(classes.panels, kind="stable")
    parts = np.split(order, np.flatnonzero(np.diff(classes.panels[order])) + 1)
    for number, K in enumerate(classes.curvatures.tolist()):
        layer = writer.layer(f"{RATIONALISED}::Moulds::{number + 1} {mould_name(K)}", mould_colour(number))
        for faces in parts:
            panel = int(classes.panels[faces[0]])
            if classes.classes[panel] == number:
                used, corners = np.unique(problem.faces[faces], return_inverse=True)
                text = {"panel": str(panel), "mould": str(number + 1), "K": repr(K)}
                mesh = mesh_from_arrays(problem.vertices[used], corners.reshape(-1, 3))
                writer.mesh(mesh, writer.attributes(layer, f"panel {panel}", text))
    on_seams = writer.layer(f"{RATIONALISED}::Seams", (20, 60, 160))
    for line in problem.crease_paths():
        writer.polyline(problem.vertices[line], writer.attributes(on_seams))
    _draw_distance(writer, problem.vertices, problem.faces, classes.distances)
    writer.document_text((texts or {}).items())
    write_archive(archive, path, 8 if source is not None and archive.ArchiveVersion >= 80 else 7)
    return notes


def _draw_distance(writer: LayerWriter, vertices: FloatArray, faces: IntArray, distances: FloatArray) -> None:
    limit = largest(distances)
    layer = writer.layer(f"{RATIONALISED}::Distance", (90, 90, 90), visible=False)
    attributes = writer.attributes(layer, "distance from the design", {"from": repr(-limit), "to": repr(limit)})
    writer.mesh(coloured(mesh_from_arrays(vertices, faces), signed_colours(distances, limit)), attributes)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    size = float(np.linalg.norm(high - low))
    steps = np.linspace(-limit, limit, 5)
    for k, (value, colour) in enumerate(zip(steps, signed_colours(steps, limit).tolist())):
        place = np.array([high[0] + 0.1 * size, low[1] + k * (high[1] - low[1]) / 5, low[2]])
        writer.dot(f"distance = {value:.3g}", place, writer.attributes(layer, "legend", colour=tuple(colour)))


def mould_colour(number: int) -> tuple[int, int, int]:
    """Return the colour of a mould by its number from 0."""
    return _COLOURS[number % len(_COLOURS)]


def mould_name(K: float) -> str:
    """Return the name of a mould of curvature `K` [1/L^2]."""
    if K == 0.0:
        return "flat"
    return f"{'sphere' if K > 0.0 else 'saddle'} of radius {abs(K) ** -0.5:.3g}"
