"""CGC Mesh: a mesh with supports and creases."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

from ...errors import CGCError
from ...io.reading import ReadProblem
from ...io.rhino.rhinocommon import problem_from_rhino
from ...io.rhino.rhinocommon import problem_from_surfaces
from ...meshing.boundary import SUPPORT_NAMES
from ...model.checks import check
from ..runtime.component_feedback import as_list
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.geometry import document_units
from ..runtime.progress import Report
from ..runtime.runner import Finished
from ..runtime.runner import Last
from ..runtime.runner import Runner
from ..runtime.widgets import offer_values
from ..runtime.wire_mesh import WireMesh

__all__ = ["CGCMeshOutputs", "cgc_mesh"]

# The first is the default: fix the points, or the boundary if there are none.
AS_DRAWN, POINTS = "as drawn", "points"
FIX = (AS_DRAWN, *SUPPORT_NAMES, POINTS)


class CGCMeshOutputs(NamedTuple):
    """Outputs of the component."""

    cgc_mesh: Optional[WireMesh] = None
    problems: Optional[list[str]] = None


_RUNNER = Runner(CGCMeshOutputs(), "reading")


@reports_errors(CGCMeshOutputs)
def cgc_mesh(
    component: Any,
    mesh: Any,
    supports: Any,
    fix: Optional[str],
    creases: Any,
    flip: Optional[bool],
    surfaces: Any = None,
    edge_length: Optional[float] = None,
) -> CGCMeshOutputs:
    """Return a mesh with supports and creases; without points, the whole boundary is fixed."""
    offer_values(component, "fix", FIX)
    if mesh is None and not as_list(surfaces):
        ask_for(component, "a mesh; or surfaces or closed curves with an edge length")
        _RUNNER.reset(component)
        return CGCMeshOutputs()
    given = (mesh, as_list(surfaces), edge_length, as_list(supports), as_list(creases))
    fixed = fix.strip() if fix else AS_DRAWN
    units = document_units()

    def work(report: Report, last: Last) -> Finished:
        return _posed(_read(*given, *units), bool(flip), fixed, bool(given[3]))

    return _RUNNER.outputs(component, (*given, flip, fixed, units), work).outputs


def _posed(read: ReadProblem, flip: bool, fixed: str, has_points: bool) -> Finished:
    """Return a problem with supports."""
    problem = read.checked()
    if flip:
        problem = problem.flipped()
    if fixed not in (AS_DRAWN, POINTS) or (fixed == AS_DRAWN and not has_points):
        problem = problem.with_supports("boundary" if fixed == AS_DRAWN else fixed, add=True)
    remarks = [("Remark", note) for note in read.notes if "support" not in note]
    # Targets are set later, by the component Target.
    sentences = [str(sentence) for sentence in check(problem) if "target" not in sentence]
    warnings = [("Warning", sentence) for sentence in sentences]
    message = f"{len(problem.vertices)} vertices, {len(problem.region_targets())} regions"
    return Finished(CGCMeshOutputs(WireMesh(problem), sentences), message, (*remarks, *warnings))


def _read(
    mesh: Any, surfaces: list[Any], edge_length: Optional[float], points: list[Any], creases: list[Any], tolerance: float, units: str
) -> ReadProblem:
    if mesh is None:
        length = None if edge_length is None else float(edge_length)
        if length is not None and not length > 0.0:
            raise CGCError(f"edge_length must be greater than zero, not {length:g}")
        return problem_from_surfaces(surfaces, length, points, creases, tolerance=tolerance, units=units)
    if surfaces:
        raise CGCError("connect either a mesh or surfaces, not both")
    return problem_from_rhino(mesh, points, creases, tolerance=tolerance, units=units)
