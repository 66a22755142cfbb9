"""Target: target Gaussian curvature of regions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any
from typing import NamedTuple
from typing import Optional

from ...errors import CGCError
from ...io.rhino.rhinocommon import points_to_array
from ...meshing.point_location import face_at
from ...model.problem import CGCProblem
from ..runtime.component_feedback import add_warning
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.component_feedback import with_nulls
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
    values = with_nulls(K)
    numbers = [value for value in values if value is not None]
    if not numbers:
        raise CGCError("connect at least one curvature K, in 1 / (model unit)²")
    wrong = [value for value in numbers if not math.isfinite(value)]
    if wrong:
        raise CGCError(f"the target must be a finite number, not {wrong[0]!r}")
    problem = cgc_mesh.to_problem()
    count = problem.number_of_regions()
    everywhere: list[Optional[int]] = list(range(count)) if len(values) > 1 else []
    chosen = _chosen(problem, with_nulls(region), with_nulls(point)) or everywhere
    if chosen and len(values) not in (1, len(chosen)):
        raise CGCError(f"there are {len(values)} curvatures for {len(chosen)} regions; connect one for all regions, or one per region")
    if not chosen:
        set_message(component, f"{count} of {count} regions")
        return TargetOutputs(WireMesh(problem.with_targets(float(numbers[0]))))
    # Nulls keep their place: the K of a null region is not used, and a region with a null K keeps its target.
    targets: dict[int, float] = {}
    for number, value in zip(chosen, values if len(values) > 1 else values * len(chosen)):
        if number is None or value is None:
            continue
        if targets.get(number, value) != value:
            add_warning(component, f"region {number} receives K = {targets[number]:.3g} and K = {value:.3g}; the last one applies")
        targets[number] = float(value)
    set_message(component, f"{len(targets)} of {count} regions")
    return TargetOutputs(WireMesh(problem.with_targets(targets)))


def _chosen(problem: CGCProblem, numbers: Sequence[Optional[int]], points: Sequence[Any]) -> list[Optional[int]]:
    """Return regions given by number, or by points on, above or below them [L]; None for nulls."""
    if numbers and points:
        raise CGCError("give the regions by number or by points, not both")
    if not points:
        return [None if number is None else int(number) for number in numbers]
    real = problem.without_dummies()
    regions = real.regions()

    def region_at(point: Any) -> int:
        return int(regions[face_at(points_to_array([point])[0], real.vertices, real.faces)[0]])

    return [None if point is None else region_at(point) for point in points]
