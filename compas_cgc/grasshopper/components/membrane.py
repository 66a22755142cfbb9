"""Membrane: forces in a solved surface under a load."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...fabrication import membrane as membrane_forces
from ...fabrication.crosses import crosses
from ...fabrication.membrane_state import forces_at_vertices
from ...io.forces import write_forces
from ...io.rhino.colours import signed_colours
from ...io.rhino.rhinocommon import mesh_from_arrays
from ...io.rhino.rhinocommon import polyline_to_rhino
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.paths import file_to_write
from ..runtime.progress import Report
from ..runtime.runner import Finished
from ..runtime.runner import Last
from ..runtime.runner import Runner

__all__ = ["MembraneOutputs", "membrane"]


class MembraneOutputs(NamedTuple):
    """Outputs of the component."""

    mesh: Any = None
    N1: Optional[list[float]] = None
    N2: Optional[list[float]] = None
    tension: Any = None
    compression: Any = None
    reactions: Any = None
    line_loads: Optional[list[float]] = None
    report: Optional[str] = None


_RUNNER = Runner(MembraneOutputs(), "computing forces")


@reports_errors(MembraneOutputs)
def membrane(
    component: Any, cgc_mesh: Any, pressure: Optional[float], weight: Optional[float], path: Optional[str], write: Optional[bool]
) -> MembraneOutputs:
    """Compute the forces under pressure and self-weight, and write them if `write` is true."""
    file = file_to_write(component, path, bool(write) and cgc_mesh is not None)
    if cgc_mesh is None:
        ask_for(component, "a solved CGC mesh")
        _RUNNER.reset(component)
        return MembraneOutputs()

    def work(report: Report, last: Last) -> Finished:
        return _forces(cgc_mesh, pressure, weight, file)

    return _RUNNER.outputs(component, (cgc_mesh, pressure, weight, file), work).outputs


def _forces(cgc_mesh: Any, pressure: Optional[float], weight: Optional[float], file: Optional[str]) -> Finished:
    if not pressure and not weight:
        pressure = 1.0
    state = membrane_forces(cgc_mesh, pressure or 0.0, weight or 0.0)
    at_vertices = forces_at_vertices(state)
    limit = float(np.percentile(np.abs(at_vertices), 98)) or 1.0
    drawn = crosses(state)
    lines, forces = drawn.lines.reshape(-1, 2, 3), drawn.forces.T.ravel()
    loaded = np.abs(state.reactions).max(axis=1) > 0
    places = state.problem.vertices[loaded]
    if file is not None:
        write_forces(file, state)
    out = MembraneOutputs(
        mesh=mesh_from_arrays(state.problem.vertices, state.problem.faces, signed_colours(at_vertices[:, 0], limit)),
        N1=at_vertices[:, 0].tolist(),
        N2=at_vertices[:, 1].tolist(),
        tension=[polyline_to_rhino(line) for line in lines[forces > 0]],
        compression=[polyline_to_rhino(line) for line in lines[forces <= 0]],
        reactions=[polyline_to_rhino([at, at + drawn.reaction_scale * force]) for at, force in zip(places, state.reactions[loaded])],
        line_loads=np.linalg.norm(state.edge_loads.load, axis=1).tolist(),
        report=state.summary(),
    )
    message = f"N1 to {state.forces[:, 0].max():.3g}, N2 from {state.forces[:, 1].min():.3g}"
    return Finished(out, message, tuple(("Remark", remark) for remark in state.remarks))
