"""Quads: plane quads and beams."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...fabrication import plane_quads
from ...fabrication.quads.plane_faces import axis_lines
from ...io.quads import write_quads
from ...io.rhino.rhinocommon import points_to_rhino
from ...io.rhino.rhinocommon import polyline_to_rhino
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.progress import Report
from ..runtime.runner import Finished
from ..runtime.runner import Last
from ..runtime.runner import Runner

__all__ = ["QuadsOutputs", "quads"]


class QuadsOutputs(NamedTuple):
    """Outputs of the component."""

    faces: Any = None
    beams: Any = None
    nodes: Any = None
    axes: Any = None
    irregular: Any = None
    planarity: Optional[list[float]] = None
    twist: Optional[list[float]] = None
    report: Optional[str] = None


_RUNNER = Runner(QuadsOutputs(), "laying out")


@reports_errors(QuadsOutputs)
def quads(
    component: Any, cgc_mesh: Any, spacing: Optional[float], depth: Optional[float] = None, path: Optional[str] = None, write: Any = None
) -> QuadsOutputs:
    """Cover a solved mesh by plane quads, and write their files if asked."""
    if cgc_mesh is None:
        ask_for(component, "a solved CGC mesh")
        _RUNNER.reset(component)
        return QuadsOutputs()
    file = path if write and path else None

    def work(report: Report, last: Last) -> Finished:
        found = plane_quads(cgc_mesh, spacing or None, depth=depth or None)
        if file is not None:
            write_quads(file, found)
        out = QuadsOutputs(
            [polyline_to_rhino(np.vstack([found.vertices[face], found.vertices[face[:1]]])) for face in found.faces],
            [polyline_to_rhino(ends) for ends in found.vertices[found.edges]],
            points_to_rhino(found.vertices),
            [polyline_to_rhino(ends) for ends in axis_lines(found)],
            points_to_rhino(found.vertices[found.irregular]),
            found.planarity.tolist(),
            found.twist.tolist(),
            found.summary(),
        )
        return Finished(out, f"{len(found.faces)} faces{', written' if file else ''}", tuple(("Remark", note) for note in found.notes))

    return _RUNNER.outputs(component, (cgc_mesh, spacing, depth, file), work).outputs
