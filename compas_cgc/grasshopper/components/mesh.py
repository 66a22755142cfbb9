"""CGC Mesh: a mesh with what holds it and where it may fold."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

from ...datastructures import CGCMesh
from ...io.rhino.rhinocommon import problem_from_rhino
from ...model.checks import check
from ..runtime.component_feedback import add_remark
from ..runtime.component_feedback import add_warning
from ..runtime.component_feedback import as_list
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.geometry import document_units

__all__ = ["CGCMeshOutputs", "cgc_mesh"]


class CGCMeshOutputs(NamedTuple):
    """Outputs of the component."""

    cgc_mesh: Optional[CGCMesh]
    problems: Optional[list[str]]


@reports_errors(CGCMeshOutputs)
def cgc_mesh(component: Any, mesh: Any, supports: Any, fix: Optional[str], creases: Any, flip: Optional[bool]) -> CGCMeshOutputs:
    """Make a mesh with supports and creases; without points the whole boundary is fixed."""
    if mesh is None:
        add_warning(component, "connect a mesh")
        return CGCMeshOutputs(None, None)
    points = as_list(supports)
    tolerance, units = document_units()
    read = problem_from_rhino(mesh, points, as_list(creases), tolerance=tolerance, units=units)
    problem = read.checked()
    if flip:
        problem = problem.flipped()
    if fix or not points:
        problem = problem.with_supports(fix.strip() if fix else "boundary", add=True)
    for note in read.notes:
        if "support" not in note:
            add_remark(component, note)
    # Targets come later, from a component of their own.
    sentences = [str(sentence) for sentence in check(problem) if "target" not in sentence]
    for sentence in sentences:
        add_warning(component, sentence)
    set_message(component, f"{len(problem.vertices)} vertices, {len(problem.region_targets())} regions")
    return CGCMeshOutputs(CGCMesh.from_problem(problem), sentences)
