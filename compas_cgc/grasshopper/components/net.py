"""Net: construction curves."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

from ...discrete.arrays import FloatArray
from ...fabrication import curve_net
from ...fabrication.option_values import NET_KINDS
from ...io.rhino.rhinocommon import points_to_array
from ...io.rhino.rhinocommon import points_to_rhino
from ...io.rhino.rhinocommon import polyline_to_rhino
from ..runtime.component_feedback import as_list
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.progress import Report
from ..runtime.runner import Finished
from ..runtime.runner import Last
from ..runtime.runner import Runner
from ..runtime.widgets import offer_values

__all__ = ["NetOutputs", "net"]


class NetOutputs(NamedTuple):
    """Outputs of the component."""

    first: Any = None
    second: Any = None
    nodes: Any = None
    sides: Optional[list[float]] = None
    report: Optional[str] = None


BY_LAW = "auto"
_RUNNER = Runner(NetOutputs(), "tracing")


@reports_errors(NetOutputs)
def net(component: Any, cgc_mesh: Any, spacing: Optional[float], through: Any, kind: Optional[str] = None) -> NetOutputs:
    """Trace lines of curvature, an asymptotic net or rulings, depending on K or `kind`."""
    offer_values(component, "kind", (BY_LAW, *NET_KINDS))
    if cgc_mesh is None:
        ask_for(component, "a solved CGC mesh")
        _RUNNER.reset(component)
        return NetOutputs()
    points, named = points_to_array(as_list(through)), (kind or "").strip().lower()
    wanted = named if named not in ("", BY_LAW) else None

    def work(report: Report, last: Last) -> Finished:
        return _traced(cgc_mesh, spacing, points, wanted)

    return _RUNNER.outputs(component, (cgc_mesh, spacing, points.tolist(), wanted), work).outputs


def _traced(cgc_mesh: Any, spacing: Optional[float], points: FloatArray, kind: Optional[str]) -> Finished:
    found = curve_net(cgc_mesh, spacing or None, through=points if len(points) else None, kind=kind)
    curves = [[polyline_to_rhino(own.points) for own in found.curves if own.family == family] for family in (0, 1)]
    out = NetOutputs(curves[0], curves[1], points_to_rhino(found.nodes), found.lengths.tolist(), found.summary())
    return Finished(out, f"{len(found.curves)} curves", tuple(("Remark", note) for note in found.notes))
