"""Component feedback: messages, balloons and scheduled runs."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from collections.abc import Sequence
from typing import Any

from ...errors import ProblemError
from .headless import is_headless
from .wires import check_wires
from .wires import single

__all__ = [
    "add_balloon",
    "add_error",
    "add_remark",
    "add_warning",
    "as_list",
    "ask_for",
    "reports_errors",
    "run_again",
    "run_later",
    "set_message",
    "unwrapped",
    "with_nulls",
]


def set_message(component: Any, text: str) -> None:
    """Show a short text below a component."""
    component.Message = text


def add_remark(component: Any, text: str) -> None:
    """Put a white balloon on a component."""
    add_balloon(component, "Remark", text)


def add_warning(component: Any, text: str) -> None:
    """Put an orange balloon on a component."""
    add_balloon(component, "Warning", text)


def add_error(component: Any, text: str) -> None:
    """Put a red balloon on a component."""
    add_balloon(component, "Error", text)


def ask_for(component: Any, text: str) -> None:
    """Request an input that is not connected: orange while somebody builds the definition, red in headless documents."""
    add_balloon(component, "Error" if is_headless(component) else "Warning", f"connect {text}")


def run_later(component: Any, milliseconds: int, callback: Callable[[], object]) -> None:
    """Call a function between two solutions of the document of a component."""
    from Grasshopper.Kernel import GH_Document

    document = component.OnPingDocument()
    if document is not None:
        document.ScheduleSolution(milliseconds, GH_Document.GH_ScheduleDelegate(lambda document: callback()))


def run_again(component: Any, milliseconds: int, on_deleted: Callable[[], object]) -> None:
    """Schedule another run of a component, or call `on_deleted` if it is no longer on the canvas."""

    def callback() -> None:
        if component.OnPingDocument() is None:
            on_deleted()
        else:
            component.ExpireSolution(False)

    run_later(component, milliseconds, callback)


def reports_errors(outputs: Any, trees: Sequence[str] = ()) -> Callable[[Callable], Callable]:
    """Return a decorator that converts user errors of a component to red balloons and empty outputs.

    Parameters
    ----------
    outputs
        NamedTuple class of the outputs.
    trees
        Names of the inputs that take data trees.
    """

    def decorate(function: Callable) -> Callable:
        names = list(inspect.signature(function).parameters)[1:]

        @functools.wraps(function)
        def run(component: Any, *inputs: Any) -> Any:
            try:
                given = [value if name in trees else unwrapped(single(name, value)) for name, value in zip(names, inputs)]
                check_wires(dict(zip(names, given)))
                return function(component, *given)
            except ProblemError as error:
                sentences = list(map(str, error.problems))
            except (ValueError, OSError) as error:
                sentences = [str(error)]
            for sentence in sentences:
                add_error(component, sentence)
            return outputs(*[None] * len(outputs._fields))

        return run

    return decorate


def unwrapped(value: Any) -> Any:
    """Return the value inside Grasshopper's wrapper for wires."""
    kind = type(value).__name__
    return value.Value if kind.startswith("GH_") and hasattr(value, "Value") else value


def as_list(values: Any) -> list:
    """Return the values of a list input without null items; a single value becomes a list."""
    if values is None:
        return []
    if isinstance(values, (str, bytes)) or not hasattr(values, "__iter__"):
        values = [values]
    return [unwrapped(value) for value in values if value is not None]


def with_nulls(values: Any) -> list:
    """Return the values of a list input with null items as None, for lists that are matched item by item."""
    if values is None:
        return []
    if isinstance(values, (str, bytes)) or not hasattr(values, "__iter__"):
        values = [values]
    return [unwrapped(value) for value in values]


def add_balloon(component: Any, level: str, text: str) -> None:
    """Put a balloon of a level on a component: Remark, Warning or Error."""
    from Grasshopper.Kernel import GH_RuntimeMessageLevel

    component.AddRuntimeMessage(getattr(GH_RuntimeMessageLevel, level), str(text))
