"""Analyse: curvatures at the vertices, and colours to see them by."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...analysis import analyse as report_on
from ...io.rhino.colours import signed_colours
from ...io.rhino.rhinocommon import mesh_from_arrays
from ...scene.figures import coloured
from ...scene.figures import figures
from ..runtime.component_feedback import add_warning
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message

__all__ = ["AnalyseOutputs", "analyse"]

LEGEND_STEPS = 7


class AnalyseOutputs(NamedTuple):
    """Outputs of the component."""

    mesh: Any
    K: Optional[list]
    H: Optional[list]
    k_max: Optional[list]
    k_min: Optional[list]
    error: Optional[list]
    colours: Optional[list]
    legend: Optional[list[str]]
    report: Optional[str]


@reports_errors(AnalyseOutputs)
def analyse(component: Any, cgc_mesh: Any, show: Optional[str], aside: Optional[float]) -> AnalyseOutputs:
    """Measure a mesh; a vertex without the figure (on an edge, on a crease) has a gap in its list."""
    if cgc_mesh is None:
        add_warning(component, "connect a CGC mesh")
        return AnalyseOutputs(*[None] * len(AnalyseOutputs._fields))
    import System

    show = show.strip() if show else "K"
    found = coloured(cgc_mesh, show)
    steps = np.linspace(-found.limit, found.limit, LEGEND_STEPS)
    colours = [System.Drawing.Color.FromArgb(*colour) for colour in signed_colours(steps, found.limit).tolist()]
    vertices, faces = cgc_mesh.arrays()
    set_message(component, f"{show}: largest {found.limit:.3g}")
    columns = {name: [None if np.isnan(x) else x for x in column.tolist()] for name, column in figures(cgc_mesh).items()}
    return AnalyseOutputs(
        mesh=mesh_from_arrays(vertices + [aside or 0.0, 0.0, 0.0], faces, found.colours),
        **columns,
        colours=colours,
        legend=[f"{step:.3g}" for step in steps],
        report=str(report_on(cgc_mesh)),
    )
