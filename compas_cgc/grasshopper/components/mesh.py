"""CGC Mesh: a mesh with what holds it and where it may fold."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

from ...io.rhino.rhinocommon import model_from_rhino
from ..runtime.component_feedback import items
from ..runtime.component_feedback import remark
from ..runtime.component_feedback import reporting
from ..runtime.component_feedback import say
from ..runtime.component_feedback import warn
from ..runtime.geometry import document_units

__all__ = ["CGCMeshOutputs", "cgc_mesh"]


class CGCMeshOutputs(NamedTuple):
    """Outputs of the component."""

    cgc_mesh: Any
    problems: Optional[list[str]]


@reporting(CGCMeshOutputs)
def cgc_mesh(component: Any, mesh: Any, supports: Any, fix: Optional[str], creases: Any, flip: Optional[bool]) -> CGCMeshOutputs:
    """Make a mesh with supports and creases; without points the whole boundary is fixed."""
    if mesh is None:
        warn(component, "connect a mesh")
        return CGCMeshOutputs(None, None)
    points = items(supports)
    tolerance, units = document_units()
    model = model_from_rhino(mesh, points, items(creases), tolerance=tolerance, units=units)
    made = model.to_cgcmesh()
    if flip:
        made.flip()
    if fix or not points:
        made.set_supports(fix.strip() if fix else "boundary", add=True)
    for note in model.notes:
        if "support" not in note:
            remark(component, note)
    # Targets come later, from a component of their own.
    problems = [problem for problem in made.check() if "target" not in problem]
    for problem in problems:
        warn(component, problem)
    say(component, f"{made.number_of_vertices()} vertices, {len(made.regions())} regions")
    return CGCMeshOutputs(made, [*map(str, problems)])
