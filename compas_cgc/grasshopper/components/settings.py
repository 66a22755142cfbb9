"""Settings: how a solve goes about it."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple
from typing import Optional

from ...errors import CGCError
from ...solvers.registry import SETTINGS
from ..runtime.component_feedback import reporting
from ..runtime.component_feedback import say

__all__ = ["SettingsOutputs", "settings"]


class SettingsOutputs(NamedTuple):
    """Outputs of the component."""

    settings: Any


@reporting(SettingsOutputs)
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
) -> SettingsOutputs:
    """Gather settings; what is not connected keeps its default, and a delay (S2) sets s to 1."""
    common = _given(steps=steps, tolerance=tolerance)
    of_flow = _given(s=s, e=delay, filter_radius=filter_radius)
    of_projection = _given(nearness=nearness, smoothness=smoothness, crease_stiffness=crease_stiffness)
    name = _method(method, of_flow, of_projection, common)
    if name is None:
        return SettingsOutputs(None)
    if of_flow.get("e") and s is None:
        of_flow["s"] = 1.0
    say(component, name)
    return SettingsOutputs(SETTINGS[name](**common, **of_flow, **of_projection))


def _method(method: Optional[str], of_flow: dict, of_projection: dict, common: dict) -> Optional[str]:
    """Return the method that settings are for, None where there are none."""
    if method and method.strip() not in SETTINGS:
        raise CGCError(f"method must be one of {', '.join(SETTINGS)}, not {method!r}; leave it unconnected to let Solve choose")
    meant = {"flow": of_flow, "projection": of_projection}
    names = [name for name, values in meant.items() if values]
    name = method.strip() if method else names[0] if names else None
    if name is None and common:
        raise CGCError("steps and tolerance mean something else in every method; say which one, flow, newton or projection")
    for other in names:
        if other != name:
            inputs = ", ".join("delay" if key == "e" else key for key in meant[other])
            raise CGCError(f"{inputs} are settings of the method {other}, not of {name}; disconnect them, or the others")
    return name


def _given(**values: Any) -> dict:
    return {name: value for name, value in values.items() if value is not None}
