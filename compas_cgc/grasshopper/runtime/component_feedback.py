"""What a component says and asks on the canvas."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

from ...errors import ProblemError

__all__ = ["error", "items", "plain", "remark", "reporting", "run_again", "say", "warn"]


def say(component: Any, text: str) -> None:
    """Write a short text under a component."""
    component.Message = text


def remark(component: Any, text: str) -> None:
    """Put a white balloon on a component."""
    _balloon(component, "Remark", text)


def warn(component: Any, text: str) -> None:
    """Put an orange balloon on a component."""
    _balloon(component, "Warning", text)


def error(component: Any, text: str) -> None:
    """Put a red balloon on a component."""
    _balloon(component, "Error", text)


def run_again(component: Any, milliseconds: int, gone: Callable[[], object]) -> None:
    """Let Grasshopper run a component again after a while, or call `gone` if it has been deleted by then."""
    from Grasshopper.Kernel import GH_Document

    def callback(document: Any) -> None:
        if component.OnPingDocument() is None:
            gone()
        else:
            component.ExpireSolution(False)

    component.OnPingDocument().ScheduleSolution(milliseconds, GH_Document.GH_ScheduleDelegate(callback))


def reporting(outputs: type) -> Callable[[Callable], Callable]:
    """Make a function of a component answer user errors with red balloons and empty outputs.

    Parameters
    ----------
    outputs
        NamedTuple of the outputs.
    """

    def decorate(function: Callable) -> Callable:
        @functools.wraps(function)
        def run(component: Any, *inputs: Any) -> Any:
            try:
                return function(component, *map(plain, inputs))
            except ProblemError as refusal:
                sentences = list(map(str, refusal.problems))
            except (ValueError, OSError) as refusal:
                sentences = [str(refusal)]
            for sentence in sentences:
                error(component, sentence)
            return outputs(*[None] * len(outputs._fields))

        return run

    return decorate


def plain(value: Any) -> Any:
    """Return what Grasshopper has wrapped for its way along a wire."""
    kind = type(value).__name__
    return value.Value if kind.startswith("GH_") and hasattr(value, "Value") else value


def items(values: Any) -> list:
    """Return a list input without its gaps; an unconnected one is empty, a single value a list of one."""
    if values is None:
        return []
    if isinstance(values, (str, bytes)) or not hasattr(values, "__iter__"):
        values = [values]
    return [plain(value) for value in values if value is not None]


def _balloon(component: Any, level: str, text: str) -> None:
    from Grasshopper.Kernel import GH_RuntimeMessageLevel

    component.AddRuntimeMessage(getattr(GH_RuntimeMessageLevel, level), str(text))
