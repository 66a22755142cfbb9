"""Rationalise: the surface nearest to a freeform design whose panels come off few moulds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...errors import CGCError
from ...io.rhino.colours import largest
from ...io.rhino.colours import signed_colours
from ...io.rhino.rhinocommon import curve_to_points
from ...io.rhino.rhinocommon import mesh_from_arrays
from ...io.rhino.rhinocommon import mesh_to_arrays
from ...io.rhino.rhinocommon import points_to_array
from ...io.rhino.rhinocommon import polyline_to_rhino
from ...rationalisation import Rationalised
from ...rationalisation import rationalise as rationalise_design
from ...rationalisation.run import Progress as Round
from ..runtime.component_feedback import add_error
from ..runtime.component_feedback import as_list
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.geometry import document_units
from ..runtime.headless import is_headless
from ..runtime.paths import file_path
from ..runtime.progress import Progress
from ..runtime.progress import Report
from ..runtime.runner import Finished
from ..runtime.runner import Last
from ..runtime.runner import Runner
from ..runtime.wire_mesh import WireMesh
from .regions import part_of

__all__ = ["RationaliseOutputs", "rationalise"]


class RationaliseOutputs(NamedTuple):
    """Outputs of the component."""

    mesh: Any = None
    cgc_mesh: Optional[WireMesh] = None
    panels: Optional[list] = None
    classes: Optional[list[int]] = None
    curvatures: Optional[list[float]] = None
    seam_lines: Optional[list] = None
    distance: Optional[list[float]] = None
    kinks: Optional[list[float]] = None
    report: Optional[str] = None


_RUNNER = Runner(RationaliseOutputs(), "assigning panels")


@reports_errors(RationaliseOutputs)
def rationalise(
    component: Any,
    design: Any,
    panel: Optional[float],
    moulds: Any,
    seams: Any,
    limit: Optional[float],
    supports: Any,
    run: Optional[bool],
    wait: Optional[bool],
) -> RationaliseOutputs:
    """Find the nearest surface in the background if `run` is true and the inputs are new."""
    if design is None:
        ask_for(component, "a design: a mesh, a CGC mesh, or the path of a file")
        return _RUNNER.pause(component)
    tolerance, _ = document_units()
    numbers = [float(value) for value in as_list(moulds)]
    lines = [curve_to_points(curve, tolerance) for curve in as_list(seams)]
    points = points_to_array(as_list(supports))
    given = file_path(component, design) if isinstance(design, str) else design

    def work(report: Report, last: Last) -> Finished:
        def watch(state: Round) -> bool:
            text = f"round {state.done} of at most {state.rounds}, distance {state.distance:.3g}"
            return report(Progress(part=state.done / max(state.rounds, 1), task=text))

        found = rationalise_design(
            _design(given),
            moulds=_moulds(numbers, limit),
            panel=panel or None,
            seams=[line.tolist() for line in lines] or None,
            within=limit or None,
            supports=points.tolist() if len(points) else None,
            callback=watch,
        )
        return _shown(found)

    inputs = (given, panel, numbers, [line.tolist() for line in lines], limit, points.tolist())
    shown = _RUNNER.outputs(component, inputs, work, run=bool(run), wait=bool(wait), brief=False)
    if not run and shown.outputs.mesh is None and is_headless(component):
        add_error(component, "run is False, so that there is no surface; set run to True")
    return shown.outputs


def _design(given: Any) -> Any:
    """Return a design of a wire; faces of Rhino meshes have four corners, of which triangles repeat the last."""
    if isinstance(given, str) or hasattr(given, "to_problem"):
        return given
    vertices, faces = mesh_to_arrays(given)
    return vertices, [list(dict.fromkeys(face)) for face in faces.tolist()]


def _moulds(numbers: Sequence[float], limit: Optional[float]) -> Any:
    """Return the number of moulds, or their radii; one value is a number."""
    if not numbers:
        return None if limit else 4
    if len(numbers) > 1:
        return list(numbers)
    if not numbers[0].is_integer():
        raise CGCError(f"moulds must be a whole number, or the radii of two or more moulds, not {numbers[0]:.3g}")
    return int(numbers[0])


def _shown(found: Rationalised) -> Finished:
    problem, signed = found.result.problem, found.distance.signed
    edges: FloatArray = problem.vertices[problem.creases]
    out = RationaliseOutputs(
        mesh=mesh_from_arrays(problem.vertices, problem.faces, signed_colours(signed, largest(signed))),
        cgc_mesh=WireMesh(problem),
        panels=[
            mesh_from_arrays(*part_of(problem.vertices, problem.faces[found.panels == number])) for number in range(len(found.classes))
        ],
        classes=np.asarray(found.classes).tolist(),
        curvatures=found.curvatures.tolist(),
        seam_lines=[polyline_to_rhino(edge) for edge in edges],
        distance=signed.tolist(),
        kinks=found.folds.angles.tolist(),
        report=found.summary,
    )
    balloons = [("Remark", note) for note in found.design.notes]
    if not found.result.converged:
        balloons.append(("Warning", found.result.message))
    elif found.suggestion:
        balloons.append(("Warning", found.suggestion))
    return Finished(out, f"{found.panelling.panel_count} panels, {len(found.curvatures)} moulds", tuple(balloons))
