"""Analyse: curvatures at the vertices, and their colours."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...io.rhino.rhinocommon import mesh_from_arrays
from ...scene.figures import FIGURES
from ..runtime.colour_legend import check_figure
from ..runtime.colour_legend import figure_colours
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.measured import measure
from ..runtime.progress import Report
from ..runtime.runner import Finished
from ..runtime.runner import Last
from ..runtime.runner import Runner
from ..runtime.widgets import offer_values

__all__ = ["AnalyseOutputs", "analyse"]


class AnalyseOutputs(NamedTuple):
    """Outputs of the component."""

    mesh: Any = None
    K: Optional[list] = None
    H: Optional[list] = None
    k_max: Optional[list] = None
    k_min: Optional[list] = None
    error: Optional[list] = None
    colours: Optional[list] = None
    legend: Optional[list[str]] = None
    report: Optional[str] = None


_RUNNER = Runner(AnalyseOutputs(), "measuring")


@reports_errors(AnalyseOutputs)
def analyse(component: Any, cgc_mesh: Any, show: Optional[str], aside: Optional[float]) -> AnalyseOutputs:
    """Measure a mesh; vertices without a value (on edges and creases) are null items in the lists."""
    offer_values(component, "show", FIGURES)
    if cgc_mesh is None:
        ask_for(component, "a CGC mesh")
        _RUNNER.reset(component)
        return AnalyseOutputs()
    figure = show.strip() if show else FIGURES[0]
    check_figure(figure)

    def work(report: Report, last: Last) -> Finished:
        return _measured(cgc_mesh, figure, aside or 0.0)

    return _RUNNER.outputs(component, (cgc_mesh, figure, aside), work).outputs


def _measured(mesh: Any, show: str, aside: float) -> Finished:
    found = measure(mesh)
    seen = figure_colours(found.figures, show)
    problem = mesh.to_problem().without_dummies()
    columns = {name: [None if np.isnan(x) else x for x in column.tolist()] for name, column in found.figures.items()}
    out = AnalyseOutputs(
        mesh=mesh_from_arrays(problem.vertices + [aside, 0.0, 0.0], problem.faces, seen.vertices),
        **columns,
        colours=seen.colours,
        legend=seen.legend,
        report=str(found.report),
    )
    return Finished(out, f"{show}: largest {seen.limit:.3g}")
