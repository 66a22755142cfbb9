"""Constraints: where vertices have to be, besides the curvature."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...errors import CGCError
from ...io.rhino.rhinocommon import curve_to_points
from ...io.rhino.rhinocommon import points_to_array
from ...meshing.polyline import points_along
from ...solvers.projection import AtHeight
from ...solvers.projection import Mirror
from ...solvers.projection import OnCurve
from ...solvers.projection import OnPlane
from ..runtime.component_feedback import items
from ..runtime.component_feedback import reporting
from ..runtime.component_feedback import say
from ..runtime.component_feedback import warn
from ..runtime.geometry import document_units
from ..runtime.geometry import plane_arrays
from ..runtime.spatial_queries import vertices_at

__all__ = ["ConstraintsOutputs", "constraints"]


class ConstraintsOutputs(NamedTuple):
    """Outputs of the component."""

    constraints: Optional[list]


@reporting(ConstraintsOutputs)
def constraints(
    component: Any, cgc_mesh: Any, points: Any, height: Optional[float], curve: Any, plane: Any, mirror: Any, others: Any
) -> ConstraintsOutputs:
    """List what is asked of vertices: those at points, or those on the curve or plane itself."""
    if cgc_mesh is None:
        warn(component, "connect a CGC mesh")
        return ConstraintsOutputs(None)
    # Constraints count the vertices of the mesh with its dummies.
    vertices, _ = cgc_mesh.arrays(dummies=True)
    snap, _ = document_units()
    chosen = vertices_at(vertices, points_to_array(items(points)), snap)
    made = list(items(others))
    if height is not None:
        if not chosen:
            raise CGCError("a height needs the points of the vertices that shall be at it")
        made.append(AtHeight(chosen, float(height)))
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
    say(component, f"{len(made)} constraint{'' if len(made) == 1 else 's'}")
    return ConstraintsOutputs(made)


def _some(found: FloatArray, what: str) -> list[int]:
    if not len(found):
        raise CGCError(f"no vertex lies on the {what}; give the points of the vertices that shall be on it")
    return sorted({int(v) for v in found})
