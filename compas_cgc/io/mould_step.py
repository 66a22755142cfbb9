"""STEP files of moulds: every mould, every panel on its mould and all panels in place as exact trimmed surfaces."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..discrete.arrays import FloatArray
from ..errors import MeshError
from ..fabrication.mould_layout import mould_places
from ..fabrication.mould_patches import Chart
from ..fabrication.mould_patches import cap_patch
from ..fabrication.mould_patches import cap_rim
from ..fabrication.mould_patches import chart_of
from ..fabrication.mould_patches import sheet_faces
from ..fabrication.mould_report import Mould
from ..fabrication.mould_report import MouldReport
from ..fabrication.mould_report import PanelFit
from ..fabrication.shell.edges import loops_of
from ..fabrication.shell.edges import region_edges
from ..fabrication.shell.panels import panel_pieces
from ..fabrication.shell.regions import region_surfaces
from ..model.problem import CGCProblem
from ..model.units import METRES
from .occt import opencascade
from .opencascade import shell_of
from .opencascade import step_content
from .opencascade import trimmed_face
from .opencascade import untrimmed_face

__all__ = ["mould_step_bytes", "panel_outline"]

POINTS_PER_EDGE = 16  # of an outline on a mould


def mould_step_bytes(problem: CGCProblem, report: MouldReport) -> tuple[bytes, list[str]]:
    """Return a STEP file in millimetres, and notes on what it does not hold.

    Its faces have the names ``mould 1``, ``lower face on mould 1`` and ``upper face on mould 1`` of the sheets, ``panel 0-1 on mould 1``
    and ``panel 0-1 in place``; the panels in place are one shell. The moulds and the panels on them lie beside the surface as in
    .3dm files.

    Parameters
    ----------
    problem
        The solved surface; its units are metres by default.
    report
        Its moulds.

    Raises
    ------
    FileError
        If the package that writes STEP files is not installed.
    """
    occt = opencascade()
    factor = 1e3 * METRES.get(problem.drawing.units or "Meters", 1.0)
    shapes, names, notes, origin = [], [], [], problem.vertices.mean(axis=0)
    for place in mould_places(problem, report):
        shapes.append(_cap(occt, place.mould, factor, place.pole - origin))
        names.append(f"mould {place.mould.number}")
        for side, offset in sheet_faces(place.mould.surface, place.mould.radius, report.sheet).items():
            shapes.append(_cap(occt, place.mould, factor, place.pole - origin, offset))
            names.append(f"{side} face on mould {place.mould.number}")
        chart = chart_of(place.mould.surface)
        for fit, pole in zip(place.panels, np.array(place.poles) - origin):
            curves = panel_outline(chart, fit)
            patch = chart.patch(chart.of(np.concatenate(curves))).placed(pole, np.eye(3)).scaled(factor)
            shapes.append(trimmed_face(occt, patch, [factor * (curve + pole) for curve in curves]))
            names.append(f"panel {fit.panel.name} on mould {place.mould.number}")
    try:
        surface = panel_pieces(problem, region_surfaces(problem), [own.panel for own in report.panels])
    except MeshError as error:
        notes.append(f"panels in place are omitted: {error}")
    else:
        shell, order = shell_of(occt, surface, lambda points: factor * (surface.centre - origin + surface.scale * points))
        shapes.append(shell)
        names += [f"panel {report.panels[k].panel.name} in place" for k in order]
    return step_content(occt.compound_from_shapes(shapes), problem.drawing.name or "compas_cgc", names, factor * origin), notes


def panel_outline(chart: Chart, fit: PanelFit) -> list[FloatArray]:
    """Return the outline of a panel on its mould as curves through points (k, 3) between its corners, in their order [L]."""
    edges = region_edges(fit.on_mould, fit.faces, np.zeros(len(fit.faces), np.int64))
    loop = max(loops_of(edges, list(range(len(edges)))), key=len)
    here, curves = int(edges[loop[0]].path[0]), []
    for k in loop:
        path = edges[k].path if edges[k].path[0] == here else edges[k].path[::-1]
        curves.append(chart.curve(fit.on_mould[path], POINTS_PER_EDGE))
        here = int(path[-1])
    return curves


def _cap(occt: Any, mould: Mould, factor: float, pole: FloatArray, offset: float = 0.0) -> Any:
    patch = cap_patch(mould.surface, mould.radius, offset).placed(pole, np.eye(3)).scaled(factor)
    if mould.surface.isotropic:
        return untrimmed_face(occt, patch)
    rim = factor * (cap_rim(mould.surface, mould.radius, offset) + pole)
    half = len(rim) // 2
    return trimmed_face(occt, patch, [rim[: half + 1], rim[half:]])
