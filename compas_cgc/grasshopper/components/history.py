"""History: convergence of a solve."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple

from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.component_feedback import set_message

__all__ = ["HistoryOutputs", "history"]


class HistoryOutputs(NamedTuple):
    """Outputs of the component."""

    step: Any
    energy: Any
    error_norm: Any
    max_error: Any
    step_length: Any


@reports_errors(HistoryOutputs)
def history(component: Any, result: Any) -> HistoryOutputs:
    """Return the values of every step, for a graph."""
    if result is None:
        ask_for(component, "the result of Solve")
        return HistoryOutputs(*[None] * len(HistoryOutputs._fields))
    rows = result.history.to_dict()
    steps = list(range(1, len(rows["energy"]) + 1))
    set_message(component, f"{len(steps)} steps")
    return HistoryOutputs(steps, rows["energy"], rows["error_norm"], rows["max_error"], rows["step_length"])
