"""Settings: method and options of a solve."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

from ...solvers import Settings
from ...solvers import settings_for
from ...solvers.registry import method_names
from ...solvers.registry import method_of
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message
from ..runtime.widgets import offer_values

__all__ = ["SettingsOutputs", "settings"]


class SettingsOutputs(NamedTuple):
    """Outputs of the component."""

    settings: Optional[Settings]


@reports_errors(SettingsOutputs)
def settings(
    component: Any,
    method: Optional[str],
    steps: Optional[int],
    tolerance: Optional[float],
    s: Optional[float],
    delay: Optional[int],
    filter_radius: Optional[float],
    nearness: Optional[float],
    smoothness: Optional[float],
    crease_stiffness: Optional[float],
    measure: Optional[str] = None,
) -> SettingsOutputs:
    """Return settings; unconnected inputs keep their defaults."""
    offer_values(component, "method", ("auto", *(name for name in method_names() if name != "auto")))
    made = settings_for(
        method.strip() if method else "auto",
        steps=steps,
        tolerance=tolerance,
        s=s,
        delay=delay,
        filter_radius=filter_radius,
        nearness=nearness,
        smoothness=smoothness,
        crease_stiffness=crease_stiffness,
        measure=measure.strip() if measure else None,
    )
    set_message(component, "" if made is None else method_of(made))
    return SettingsOutputs(made)
