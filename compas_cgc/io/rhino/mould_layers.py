"""Writing of moulds, panels on moulds, panels in their final position, and labels on separate layers of a .3dm file."""

from __future__ import annotations

import json
import os
from typing import Optional
from typing import Union

import numpy as np

from ..._version import __version__
from ...discrete.arrays import Faces
from ...discrete.arrays import FloatArray
from ...discrete.arrays import Vertices
from ...errors import names_what_was_meant
from ...fabrication.mould_layout import MouldPlace
from ...fabrication.mould_layout import mould_places
from ...fabrication.mould_patches import cap_patch
from ...fabrication.mould_patches import cap_rim
from ...fabrication.mould_patches import sheet_faces
from ...fabrication.mould_report import MouldReport
from ...fabrication.mould_report import PanelFit
from ...meshing import boundary_loops
from ...model.problem import PosesProblem
from .archive import read_archive
from .archive import write_archive
from .layers import MOULDS
from .meshes import mesh_from_arrays
from .nurbs import nurbs_surface
from .write import LayerWriter
from .write import new_archive

__all__ = ["write_moulds"]

_COLOURS = ((232, 196, 143), (127, 166, 173), (207, 132, 101), (167, 181, 139), (141, 147, 181), (217, 165, 160))


@names_what_was_meant()
def write_moulds(
    path: Union[str, os.PathLike],
    mesh: PosesProblem,
    report: MouldReport,
    source: Union[str, os.PathLike, None] = None,
    version: int = 7,
) -> None:
    """Write moulds and panels on the sublayers of ``CGC Moulds``, in addition to the contents of a file.

    ==================  ====================================================================================
    Moulds              the exact surface of each mould beside the roof, pole upwards, with its data as user text; the cap for planes and
                        spheres, a rectangle around the cap, and its rim, for pseudospheres
    Faces               the lower and the upper face of the sheets on each mould, half of the thickness from it, hidden
    Outlines            the outlines of all panels on their mould
    Panels on moulds    every panel on its mould, side by side
    Panels in place     every panel in the roof, with its data as user text
    Labels              the names of the moulds, and of the panels in both positions
    ==================  ====================================================================================

    Parameters
    ----------
    path
        The .3dm file; an existing file is replaced when the new one is complete.
    mesh
        The solved surface.
    report
        Report from :func:`compas_cgc.fabrication.moulds`.
    source
        A .3dm file whose contents are kept, except for earlier moulds.
    version
        7 or 8.

    Raises
    ------
    FileError
        If the source cannot be read or the file cannot be written.

    Examples
    --------
    >>> import compas_cgc, os, tempfile
    >>> from compas_cgc.fabrication import moulds, panels
    >>> result = compas_cgc.solve(compas_cgc.read(compas_cgc.get("vault.3dm")))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_moulds(os.path.join(folder, "moulds.3dm"), result, moulds(result, panels(result, 3.0)))
    ...     print(os.listdir(folder))
    ['moulds.3dm']
    """
    problem = mesh.to_problem().without_dummies()
    writer = LayerWriter(new_archive(problem) if source is None else read_archive(source))
    writer.clear(MOULDS)
    for place in mould_places(problem, report):
        colour = _COLOURS[(place.mould.number - 1) % len(_COLOURS)]
        _draw_mould(writer, place, colour)
        _draw_faces(writer, place, report.sheet)
        _draw_in_place(writer, place.panels, colour)
    record = {"version": __version__, **report.to_dict()}
    writer.document_text([("compas_cgc.moulds", json.dumps(record)), ("compas_cgc.moulds.report", str(report))])
    write_archive(writer.archive, path, version)


def _draw_mould(writer: LayerWriter, place: MouldPlace, colour: tuple) -> None:
    """Draw a mould and its panels in rows."""
    mould, middle = place.mould, place.pole
    radius = mould.radius_of_curvature
    figures = {"mould": str(mould.number), "K": repr(mould.K), "cap radius": repr(mould.radius), "panels": str(mould.panels)}
    figures.update({} if radius is None else {"radius of curvature": repr(radius)})
    figures.update({"kind": mould.kind} if mould.size is None else {"kind": mould.kind, "size": repr(mould.size)})
    on_moulds = writer.layer(f"{MOULDS}::Moulds", (90, 90, 90))
    surface = cap_patch(mould.surface, mould.radius).placed(middle, np.eye(3))
    writer.archive.Objects.AddSurface(nurbs_surface(surface), writer.attributes(on_moulds, f"mould {mould.number}", figures))
    if not mould.surface.isotropic:
        rim = cap_rim(mould.surface, mould.radius) + middle
        writer.polyline(rim, writer.attributes(on_moulds, f"rim of mould {mould.number}"))
    on_labels = writer.layer(f"{MOULDS}::Labels", (40, 40, 40))
    writer.dot(f"mould {mould.number}", middle, writer.attributes(on_labels, f"mould {mould.number}"))
    on_outlines = writer.layer(f"{MOULDS}::Outlines", (20, 60, 160))
    on_panels = writer.layer(f"{MOULDS}::Panels on moulds", (140, 110, 60))
    for fit, pole in zip(place.panels, place.poles):
        attributes = writer.attributes(on_panels, fit.panel.name, _figures(fit), colour)
        writer.mesh(mesh_from_arrays(fit.on_mould + pole, fit.faces), attributes)
        writer.dot(fit.panel.name, pole + _middle(fit.on_mould), writer.attributes(on_labels, fit.panel.name))
        for loop in boundary_loops(fit.faces):
            line = fit.on_mould[np.append(loop, loop[0])] + middle
            writer.polyline(line, writer.attributes(on_outlines, fit.panel.name))


def _draw_faces(writer: LayerWriter, place: MouldPlace, thickness: float) -> None:
    """Draw the faces of the sheets on a mould, on which tools bear."""
    layer = writer.layer(f"{MOULDS}::Faces", (120, 120, 120), visible=False)
    surface, radius = place.mould.surface, place.mould.radius
    for side, offset in sheet_faces(surface, radius, thickness).items():
        name = f"{side} face on mould {place.mould.number}"
        patch = nurbs_surface(cap_patch(surface, radius, offset).placed(place.pole, np.eye(3)))
        writer.archive.Objects.AddSurface(patch, writer.attributes(layer, name, {"offset": repr(offset)}))
        if not surface.isotropic:
            writer.polyline(cap_rim(surface, radius, offset) + place.pole, writer.attributes(layer, f"rim of the {name}"))


def _draw_in_place(writer: LayerWriter, panels: list[PanelFit], colour: tuple) -> None:
    on_place = writer.layer(f"{MOULDS}::Panels in place", (120, 120, 120))
    on_labels = writer.layer(f"{MOULDS}::Labels", (40, 40, 40))
    for fit in panels:
        attributes = writer.attributes(on_place, fit.panel.name, _figures(fit), colour)
        writer.mesh(mesh_from_arrays(fit.vertices, _upright(fit)), attributes)
        writer.dot(fit.panel.name, _middle(fit.vertices), writer.attributes(on_labels, fit.panel.name))


def _upright(fit: PanelFit) -> Faces:
    """Return the faces of a panel (m, 3) oriented as in the roof; those of concave panels are reversed on the mould."""
    faces = fit.faces
    corners = fit.vertices[faces]
    up = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2].sum()
    return faces if up >= 0.0 else faces[:, ::-1]


def _middle(points: Vertices) -> FloatArray:
    return points[np.argmin(np.linalg.norm(points - points.mean(axis=0), axis=1))]


def _figures(fit: PanelFit) -> dict[str, str]:
    """Return the data of a panel as user text."""
    named: dict[str, Optional[float]] = {
        "cap radius": fit.radius,
        "gap mm": fit.gap,
        "edge error": fit.edge_error,
        "deviation without bending mm": fit.rigid,
        "change of curvature 1/m": fit.change,
        "stress MPa": fit.stress,
    }
    values = {name: repr(value) for name, value in named.items() if value is not None}
    return {"panel": fit.panel.name, "region": str(fit.panel.region), "mould": str(fit.mould), **values}
