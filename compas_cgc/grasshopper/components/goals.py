"""Goals: requirements on a surface besides its curvature."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

import numpy as np

from ...discrete.arrays import FloatArray
from ...errors import CGCError
from ...io.rhino.rhinocommon import curve_to_points
from ...model.constraints import Constraint
from ...model.constraints import Height
from ...model.counts import counted
from ...model.goals.inequalities import Above
from ...model.goals.inequalities import Below
from ...model.goals.inequalities import Clearance
from ...model.goals.inequalities import Within
from ...model.goals.numbers import ALL
from ...model.goals.places import EdgeInPlan
from ...model.goals.places import Level
from ...model.goals.wholes import Area
from ...model.goals.wholes import Rise
from ...model.goals.wholes import Unknown
from ...model.goals.wholes import Volume
from ..runtime.component_feedback import as_list
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.component_feedback import with_nulls
from ..runtime.geometry import document_units

__all__ = ["GoalsOutputs", "goals"]

ALL_REGIONS = -1


class GoalsOutputs(NamedTuple):
    """Outputs of the component."""

    goals: Optional[list]


@reports_errors(GoalsOutputs)
def goals(
    component: Any,
    rise: Optional[float],
    height: Optional[float],
    volume: Optional[float],
    area: Optional[float],
    clear: Any,
    clearance: Any,
    below: Optional[float],
    within: Any,
    keep_edges: Optional[bool],
    level_edges: Optional[bool],
    unknown: Any,
    others: Any,
) -> GoalsOutputs:
    """Return goals of the surface, including regions with unknown K."""
    made: list[Any] = list(as_list(others))
    if rise is not None:
        made.append(Rise(float(rise)))
    if height is not None:
        made.append(Height("crown", float(height)))
    if volume is not None:
        made.append(Volume(float(volume)))
    if area is not None:
        made.append(Area(float(area)))
    made += _clear(with_nulls(clearance), with_nulls(clear))
    if below is not None:
        made.append(Below(float(below)))
    if within is not None:
        made.append(Within(_outline(within, "within").tolist()))
    made += [EdgeInPlan()] if keep_edges else []
    made += [Level()] if level_edges else []
    regions = [int(region) for region in as_list(unknown)]
    if regions:
        made.append(Unknown(ALL if ALL_REGIONS in regions else regions))
    set_message(component, counted(len(made), "goal"))
    return GoalsOutputs(made)


def _clear(heights: list[Optional[float]], curves: list[Any]) -> list[Constraint]:
    """Return clearances inside curves, or everywhere if there are no curves. Nulls keep their place: their curve has no clearance."""
    if not curves:
        return [Above(float(height)) for height in heights[:1] if height is not None]
    if len(heights) not in (1, len(curves)):
        raise CGCError(f"there are {len(heights)} clearances for {len(curves)} curves; connect one for all curves, or one per curve")
    each = heights * len(curves) if len(heights) == 1 else heights
    pairs = [(curve, height) for curve, height in zip(curves, each) if curve is not None and height is not None]
    return [Clearance(_outline(curve, "clear").tolist(), float(height)) for curve, height in pairs]


def _outline(curve: Any, name: str) -> FloatArray:
    """Return a closed curve in plan (p, 2)."""
    snap, _ = document_units()
    points = curve_to_points(curve, 0.1 * snap)
    if len(points) < 4 or float(np.abs(points[0] - points[-1]).max()) > snap:
        raise CGCError(f"a curve at the input {name} is open; connect closed curves")
    return points[:-1, :2]
