"""Target: target Gaussian curvature or law of regions."""

from __future__ import annotations

import math
from collections.abc import Callable
from collections.abc import Sequence
from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...errors import CGCError
from ...io.rhino.rhinocommon import points_to_array
from ...meshing.point_location import face_at
from ...model.problem import CGCProblem
from ..runtime.component_feedback import add_warning
from ..runtime.component_feedback import as_list
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.component_feedback import with_nulls
from ..runtime.widgets import offer_slider
from ..runtime.wire_mesh import WireMesh

__all__ = ["TargetOutputs", "target"]


class TargetOutputs(NamedTuple):
    """Outputs of the component."""

    cgc_mesh: Optional[WireMesh]


@reports_errors(TargetOutputs)
def target(component: Any, cgc_mesh: Any, K: Any, region: Any, point: Any, law: Any = None, radius: Any = None) -> TargetOutputs:
    """Set target curvatures or laws of all regions, of regions by number, or of the regions at points."""
    if cgc_mesh is None:
        ask_for(component, "a CGC mesh")
        return TargetOutputs(None)
    values, laws = with_nulls(K), with_nulls(law)
    if as_list(radius):
        if as_list(K):
            raise CGCError("connect either K or radius, not both")
        values = [None if R is None else _curvature(float(R)) for R in with_nulls(radius)]
    problem = cgc_mesh.to_problem()
    numbers, texts = ([value for value in given if value is not None] for given in (values, laws))
    if not numbers and not texts:
        offer_slider(component, "radius", *_radii(problem), others=("cgc_mesh", "region", "point"))
        raise CGCError("connect at least one curvature K, in 1 / (model unit)², or one law such as H = 0.1")
    wrong = [value for value in numbers if not math.isfinite(value)]
    if wrong:
        raise CGCError(f"the target must be a finite number, not {wrong[0]!r}")
    count = problem.number_of_regions()
    everywhere: list[Optional[int]] = list(range(count)) if max(len(values), len(laws)) > 1 else []
    chosen = _chosen(problem, with_nulls(region), with_nulls(point)) or everywhere
    for given, what in ((values, "curvatures"), (laws, "laws")):
        if chosen and len(given) not in (0, 1, len(chosen)):
            raise CGCError(f"there are {len(given)} {what} for {len(chosen)} regions; connect one for all regions, or one per region")
    if not chosen:
        set_message(component, f"{count} of {count} regions")
        problem = problem.with_targets(float(numbers[0])) if numbers else problem
        return TargetOutputs(WireMesh(problem.with_laws(str(texts[0])) if texts else problem))
    targets = _by_region(component, chosen, values, lambda value: f"K = {value:.3g}")
    others = _by_region(component, chosen, laws, str)
    set_message(component, f"{len({**targets, **others})} of {count} regions")
    problem = problem.with_targets({number: float(value) for number, value in targets.items()})
    return TargetOutputs(WireMesh(problem.with_laws(others)))


def _radii(problem: CGCProblem) -> tuple[float, float, float]:
    """Return the smallest radius, the largest and one in between for a slider [L], of two significant digits.

    The smallest sphere has its equator through the corners of the plan.
    """
    points = problem.without_dummies().vertices[:, :2]
    half = 0.5 * float(np.linalg.norm(np.ptp(points, axis=0)))
    low, value = (float(f"{factor * half:.1e}") for factor in (1.0, 2.0))
    return low, 10.0 * low, value


def _curvature(radius: float) -> float:
    """Return K of a sphere, or of a saddle with a negative radius [1/L^2]; an infinite radius is flat."""
    if not abs(radius) > 0.0:
        raise CGCError(f"radius must be a number other than 0, in model units, not {radius:g}")
    return math.copysign(1.0 / radius**2, radius)


def _by_region(component: Any, chosen: Sequence[Optional[int]], values: Sequence[Any], shown: Callable[[Any], str]) -> dict[int, Any]:
    """Return values by region; nulls keep their place: the value of a null region is not used, a region with a null value keeps its own."""
    found: dict[int, Any] = {}
    for number, value in zip(chosen, values if len(values) > 1 else list(values) * len(chosen)):
        if number is None or value is None:
            continue
        if found.get(number, value) != value:
            add_warning(component, f"region {number} receives {shown(found[number])} and {shown(value)}; the last one applies")
        found[number] = value
    return found


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
