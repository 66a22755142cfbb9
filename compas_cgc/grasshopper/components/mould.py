"""Mould: panels of a solved surface and their moulds."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...fabrication import MouldReport
from ...fabrication import moulds
from ...fabrication import panels
from ...fabrication.mould_surface import cap_mesh
from ...io.rhino.rhinocommon import curve_to_points
from ...io.rhino.rhinocommon import mesh_from_arrays
from ...model.counts import counted
from ...model.problem import CGCProblem
from ..runtime.component_feedback import as_list
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.geometry import document_units
from ..runtime.progress import Report
from ..runtime.runner import Finished
from ..runtime.runner import Last
from ..runtime.runner import Runner

__all__ = ["MouldOutputs", "mould"]

MOULD_OFFSET = 0.15  # distance of the moulds from the surface, relative to its size


class MouldOutputs(NamedTuple):
    """Outputs of the component."""

    panels: Optional[list] = None
    on_moulds: Optional[list] = None
    moulds: Optional[list] = None
    names: Optional[list[str]] = None
    mould: Optional[list[int]] = None
    misses: Optional[list[float]] = None
    change: Optional[list] = None
    stress: Optional[list] = None
    report: Optional[str] = None


_RUNNER = Runner(MouldOutputs(), "fitting panels")


@reports_errors(MouldOutputs)
def mould(
    component: Any,
    cgc_mesh: Any,
    size: Optional[float],
    count: Optional[int],
    curves: Any,
    along: Optional[str],
    material: Optional[str],
    thickness: Optional[float],
    tolerance: Optional[float],
    least_bending: Optional[bool],
    rough: Optional[bool],
    aside: Optional[float],
) -> MouldOutputs:
    """Divide a surface into panels, and place them on one mould per curvature."""
    if cgc_mesh is None:
        ask_for(component, "a solved CGC mesh")
        _RUNNER.reset(component)
        return MouldOutputs()
    sampling, _ = document_units()
    lines = [curve_to_points(curve, sampling) for curve in as_list(curves)]
    if size is None and count is None and not lines:
        count = 1
    choices = (size, count, along, material, thickness, tolerance, least_bending, rough, aside)
    inputs = (cgc_mesh, *choices, [line.tolist() for line in lines])

    def work(report: Report, last: Last) -> Finished:
        problem = cgc_mesh.to_problem().without_dummies()
        divided = panels(problem, size, count=count, curves=lines or None, along=along.strip() if along else "plan")
        chosen = material.strip() if material else "glass"
        fitted = moulds(
            problem,
            divided,
            material=chosen,
            thickness=6.0 if thickness is None else thickness,
            tolerance=tolerance or 0.0,
            least_bending=bool(least_bending),
            rough=bool(rough),
        )
        return _shown(problem, fitted, aside)

    return _RUNNER.outputs(component, inputs, work).outputs


def _shown(problem: CGCProblem, report: MouldReport, aside: Optional[float]) -> Finished:
    """Return panels in place and on moulds beside the surface."""
    low, high = problem.vertices.min(axis=0), problem.vertices.max(axis=0)
    away = MOULD_OFFSET * float(np.linalg.norm(high - low)) + high[0] if aside is None else high[0] + aside
    places, shown = [], []
    corner = np.array([away, low[1], low[2]])
    for own in report.moulds:
        # The moulds are arranged in a column in plan, each with all its panels.
        places.append(corner + own.radius)
        vertices, faces = cap_mesh(own.surface, own.radius)
        shown.append(mesh_from_arrays(vertices + places[-1], faces))
        corner = corner + [0.0, 2.5 * own.radius, 0.0]
    out = MouldOutputs(
        [mesh_from_arrays(fit.vertices, fit.faces) for fit in report.panels],
        [mesh_from_arrays(fit.on_mould + places[fit.mould - 1], fit.faces) for fit in report.panels],
        shown,
        [fit.panel.name for fit in report.panels],
        [fit.mould - 1 for fit in report.panels],
        [fit.rigid for fit in report.panels],
        [fit.change for fit in report.panels],
        [fit.stress for fit in report.panels],
        str(report),
    )
    return Finished(out, f"{counted(len(report.panels), 'panel')}, {counted(len(shown), 'mould')}")
