"""Target: target Gaussian curvature of regions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any
from typing import NamedTuple
from typing import Optional

from ...discrete.arrays import FloatArray
from ...errors import CGCError
from ...io.rhino.rhinocommon import points_to_array
from ...meshing.point_location import face_at
from ...model.problem import CGCProblem
from ..runtime.component_feedback import add_warning
from ..runtime.component_feedback import as_list
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.wire_mesh import WireMesh

__all__ = ["TargetOutputs", "target"]


class TargetOutputs(NamedTuple):
    """Outputs of the component."""

    cgc_mesh: Optional[WireMesh]


@reports_errors(TargetOutputs)
def target(component: Any, cgc_mesh: Any, K: Any, region: Any, point: Any) -> TargetOutputs:
    """Set target curvatures of all regions, of regions by number, or of the regions at points."""
    if cgc_mesh is None:
        add_warning(component, "connect a CGC mesh")
        return TargetOutputs(None)
    values = as_list(K)
    if not values:
        raise CGCError("connect at least one curvature K, in 1 / (model unit)²")
    wrong = [value for value in values if not math.isfinite(value)]
    if wrong:
        raise CGCError(f"the target must be a finite number, not {wrong[0]!r}")
    problem = cgc_mesh.to_problem()
    count = problem.number_of_regions()
    everywhere = list(range(count)) if len(values) > 1 else []
    chosen = _chosen(problem, as_list(region), points_to_array(as_list(point))) or everywhere
    if chosen and len(values) not in (1, len(chosen)):
        raise CGCError(f"there are {len(values)} curvatures for {len(chosen)} regions; connect one for all regions, or one per region")
    set_message(component, f"{len(set(chosen)) or count} of {count} regions")
    if not chosen:
        return TargetOutputs(WireMesh(problem.with_targets(float(values[0]))))
    given = values if len(values) > 1 else values * len(chosen)
    return TargetOutputs(WireMesh(problem.with_targets(dict(zip(chosen, map(float, given))))))


def _chosen(problem: CGCProblem, numbers: Sequence[int], points: FloatArray) -> list[int]:
    """Return regions given by number, or by points (k, 3) on, above or below them [L]."""
    if numbers and len(points):
        raise CGCError("give the regions by number or by points, not both")
    if not len(points):
        return [int(number) for number in numbers]
    real = problem.without_dummies()
    regions = real.regions()
    return [int(regions[face_at(place, real.vertices, real.faces)[0]]) for place in points]
