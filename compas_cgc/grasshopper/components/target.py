"""Target: which Gaussian curvature is wanted where."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple

from ...errors import CGCError
from ...io.rhino.rhinocommon import points_to_array
from ..runtime.component_feedback import items
from ..runtime.component_feedback import reporting
from ..runtime.component_feedback import say
from ..runtime.component_feedback import warn
from ..runtime.spatial_queries import region_at

__all__ = ["TargetOutputs", "target"]


class TargetOutputs(NamedTuple):
    """Outputs of the component."""

    cgc_mesh: Any


@reporting(TargetOutputs)
def target(component: Any, cgc_mesh: Any, K: Any, region: Any, point: Any) -> TargetOutputs:
    """Ask for curvatures everywhere, by the numbers of regions, or at points in them."""
    if cgc_mesh is None:
        warn(component, "connect a CGC mesh")
        return TargetOutputs(None)
    values, regions, points = items(K), items(region), points_to_array(items(point))
    if regions and len(points):
        raise CGCError("give the regions by number or by points, not both")
    if not values:
        raise CGCError("give at least one curvature K, in 1 / (model unit)²")
    mesh = cgc_mesh.copy()
    count = len(mesh.regions())
    if len(points):
        chosen = [region_at(mesh, place) for place in points]
    elif regions:
        chosen = [int(number) for number in regions]
    else:
        chosen = [] if len(values) == 1 else list(range(count))
    if chosen and len(values) not in (1, len(chosen)):
        raise CGCError(f"there are {len(values)} curvatures for {len(chosen)} regions; give one, or one for each")
    if not chosen:
        mesh.set_target(values[0])
    for number, value in zip(chosen, values if len(values) > 1 else values * len(chosen)):
        mesh.set_target(value, region=number)
    say(component, f"{len(set(chosen)) or count} of {count} regions")
    return TargetOutputs(mesh)
