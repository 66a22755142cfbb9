"""Constraints on the positions of vertices."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.arrays import IntArray
from ...errors import CGCError
from ...io.rhino.rhinocommon import curve_to_points
from ...io.rhino.rhinocommon import points_to_array
from ...meshing.point_location import vertices_at
from ...meshing.polyline import points_along
from ...model.constraints import Height
from ...model.constraints import Mirror
from ...model.constraints import OnCurve
from ...model.constraints import OnPlane
from ...model.counts import counted
from ..runtime.component_feedback import as_list
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.geometry import document_units
from ..runtime.geometry import plane_arrays

__all__ = ["ConstraintsOutputs", "constraints"]


class ConstraintsOutputs(NamedTuple):
    """Outputs of the component."""

    goals: Optional[list]


@reports_errors(ConstraintsOutputs)
def constraints(
    component: Any, cgc_mesh: Any, points: Any, height: Optional[float], curve: Any, plane: Any, mirror: Any, others: Any
) -> ConstraintsOutputs:
    """Return constraints of the vertices at points, or of the vertices on the curve or plane if there are no points."""
    if cgc_mesh is None:
        ask_for(component, "a CGC mesh")
        return ConstraintsOutputs(None)
    # Vertex indices of constraints include dummy vertices.
    vertices = cgc_mesh.to_problem().vertices
    snap, _ = document_units()
    chosen = vertices_at(vertices, points_to_array(as_list(points)), snap)
    made = list(as_list(others))
    if height is not None:
        if not chosen:
            raise CGCError("a height requires points at the constrained vertices")
        made.append(Height(chosen, float(height)))
    if curve is not None:
        along = curve_to_points(curve, 0.1 * snap)
        closed = len(along) > 2 and bool(np.linalg.norm(along[0] - along[-1]) <= snap)
        on = chosen or _some(points_along(vertices, along, snap), "curve")
        made.append(OnCurve(on, (along[:-1] if closed else along).tolist(), closed))
    if plane is not None:
        origin, normal = plane_arrays(plane)
        on = chosen or _some(np.flatnonzero(np.abs((vertices - origin) @ normal) <= snap), "plane")
        made.append(OnPlane(on, origin.tolist(), normal.tolist()))
    if mirror is not None:
        origin, normal = plane_arrays(mirror)
        made.append(Mirror(origin.tolist(), normal.tolist()))
    set_message(component, counted(len(made), "constraint"))
    return ConstraintsOutputs(made)


def _some(found: IntArray, what: str) -> list[int]:
    if not len(found):
        raise CGCError(f"no vertex lies on the {what}; connect points at the constrained vertices")
    return sorted({int(v) for v in found})
