"""Net: construction curves."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

from ...fabrication import curve_net
from ...io.rhino.rhinocommon import points_to_array
from ...io.rhino.rhinocommon import points_to_rhino
from ...io.rhino.rhinocommon import polyline_to_rhino
from ..runtime.component_feedback import add_remark
from ..runtime.component_feedback import add_warning
from ..runtime.component_feedback import as_list
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message

__all__ = ["NetOutputs", "net"]


class NetOutputs(NamedTuple):
    """Outputs of the component."""

    first: Any
    second: Any
    nodes: Any
    sides: Optional[list[float]]
    report: Optional[str]


@reports_errors(NetOutputs)
def net(component: Any, cgc_mesh: Any, spacing: Optional[float], through: Any) -> NetOutputs:
    """Trace lines of curvature, an asymptotic net or rulings, depending on K."""
    if cgc_mesh is None:
        add_warning(component, "connect a solved CGC mesh")
        return NetOutputs(*[None] * len(NetOutputs._fields))
    points = points_to_array(as_list(through))
    found = curve_net(cgc_mesh, spacing or None, through=points if len(points) else None)
    for note in found.notes:
        add_remark(component, note)
    curves = [[polyline_to_rhino(own.points) for own in found.curves if own.family == family] for family in (0, 1)]
    set_message(component, f"{len(found.curves)} curves")
    return NetOutputs(curves[0], curves[1], points_to_rhino(found.nodes), found.lengths.tolist(), found.summary())
