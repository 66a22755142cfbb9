"""Rationalise: the surface with panels from few moulds that is nearest to a freeform design."""

from __future__ import annotations

import json
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
from ...model.counts import counted
from ...model.problem import CGCProblem
from ...rationalisation import Rationalised
from ...rationalisation import rationalise as rationalise_design
from ...rationalisation.costs import costs_in_order
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
from ..runtime.saved import problem_from_text
from ..runtime.saved import problem_to_text
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


class _Found(NamedTuple):
    """What was found, for the outputs and for the file of the definition."""

    problem: CGCProblem
    panels: list[int]  # panel of each face
    classes: list[int]  # mould of each panel
    curvatures: list[float]  # K of each mould [1/L^2]
    distance: list[float]  # signed distance of each vertex from the design [L]
    kinks: list[float]  # folds at seams [degree]
    report: str
    message: str  # text below the component
    balloons: tuple[tuple[str, str], ...]

    @classmethod
    def of(cls, found: Rationalised) -> _Found:
        """Return what a computation has found."""
        balloons = [("Remark", note) for note in found.design.notes]
        if not found.result.converged:
            balloons.append(("Warning", found.result.message))
        elif found.suggestion:
            balloons.append(("Warning", found.suggestion))
        return cls(
            found.result.problem,
            found.panels.tolist(),
            np.asarray(found.classes).tolist(),
            found.curvatures.tolist(),
            found.distance.signed.tolist(),
            found.folds.angles.tolist(),
            found.summary,
            f"{counted(found.panelling.panel_count, 'panel')}, {counted(len(found.curvatures), 'mould')}",
            tuple(balloons),
        )

    @classmethod
    def from_text(cls, text: str) -> _Found:
        """Return what is in the file of the definition."""
        data = json.loads(text)
        balloons = tuple((level, sentence) for level, sentence in data["balloons"])
        return cls(**{**data, "problem": problem_from_text(data["problem"]), "balloons": balloons})

    def to_text(self) -> str:
        """Return the text for the file of the definition."""
        return json.dumps({**self._asdict(), "problem": problem_to_text(self.problem)})

    def outputs(self) -> RationaliseOutputs:
        """Return the outputs."""
        vertices, faces = self.problem.vertices, self.problem.faces
        edges: FloatArray = vertices[self.problem.creases]
        signed, panels = np.array(self.distance), np.array(self.panels)
        return RationaliseOutputs(
            mesh=mesh_from_arrays(vertices, faces, signed_colours(signed, largest(signed))),
            cgc_mesh=WireMesh(self.problem),
            panels=[mesh_from_arrays(*part_of(vertices, faces[panels == number])) for number in range(len(self.classes))],
            classes=self.classes,
            curvatures=self.curvatures,
            seam_lines=[polyline_to_rhino(edge) for edge in edges],
            distance=self.distance,
            kinks=self.kinks,
            report=self.report,
        )


def _finished(found: _Found, text: str = "") -> Finished:
    return Finished(found.outputs(), found.message, found.balloons, found, text)


_RUNNER = Runner(RationaliseOutputs(), "assigning panels", lambda text: _finished(_Found.from_text(text)))


@reports_errors(RationaliseOutputs)
def rationalise(
    component: Any,
    design: Any,
    panel: Optional[float],
    moulds: Any,
    seams: Any,
    limit: Optional[float],
    supports: Any,
    costs: Any,
    weights: Any,
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
    prices, places = ([float(value) for value in as_list(given)] for given in (costs, weights))
    given = file_path(component, design) if isinstance(design, str) else design

    def work(report: Report, last: Last) -> Finished:
        if last.current:
            return _finished(last.value)

        def watch(state: Round) -> bool:
            text = f"round {state.done} of at most {state.rounds}, distance {state.distance:.3g}"
            return report(Progress(part=state.done / max(state.rounds, 1), task=text))

        done = rationalise_design(
            _design(given),
            moulds=_moulds(numbers, limit),
            panel=panel or None,
            seams=[line.tolist() for line in lines] or None,
            within=limit or None,
            supports=points.tolist() if len(points) else None,
            costs=costs_in_order(prices),
            weights=places,
            callback=watch,
        )
        found = _Found.of(done)
        return _finished(found, found.to_text())

    inputs = (given, panel, numbers, [line.tolist() for line in lines], limit, points.tolist(), prices, places)
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
