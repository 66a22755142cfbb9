"""Widgets: value lists and sliders at the inputs of a new component."""

from __future__ import annotations

import math
from collections.abc import Callable
from collections.abc import Sequence
from typing import Any
from typing import Optional

__all__ = ["offer_slider", "offer_values"]

GAP = 30.0  # distance between a list and the input [pixel]
DELAY = 5  # [ms]; the canvas must not be changed during a solution

_OFFERED: set[tuple[str, str]] = set()


def offer_values(component: Any, name: str, values: Sequence[str]) -> None:
    """Add a value list to an input, once, if nothing is connected to the component yet.

    A deleted list is not added again, and saved definitions are not changed.

    Parameters
    ----------
    component
        The component.
    name
        Name of the input.
    values
        Texts to choose from; the first one is selected and must be equivalent to the default.
    """
    _offer(component, name, lambda: _value_list(name, values), ())


def offer_slider(component: Any, name: str, low: float, high: float, value: float, others: Sequence[str]) -> None:
    """Add a number slider to an input, once, if nothing but some `others` is connected to the component yet.

    Parameters
    ----------
    component
        The component.
    name
        Name of the input.
    low, high
        Range, in hundredths of whose order of magnitude the slider moves.
    value
        First value.
    others
        Names of inputs that may be connected.
    """
    _offer(component, name, lambda: _slider(name, low, high, value), others)


def _offer(component: Any, name: str, make: Callable[[], Any], others: Sequence[str]) -> None:
    parameter, document = _input(component, name), component.OnPingDocument()
    key = (str(component.InstanceGuid), name)
    if parameter is None or document is None or key in _OFFERED:
        return
    _OFFERED.add(key)
    if any(own.SourceCount for own in component.Params.Input if own.Name not in others):
        return
    from Grasshopper.Kernel import GH_Document

    def create(document: Any) -> None:
        if parameter.SourceCount:
            return
        made = make()
        made.CreateAttributes()
        made.Attributes.Pivot = parameter.Attributes.Pivot
        document.AddObject(made, False)
        parameter.AddSource(made)
        _place_before(made, parameter)
        component.ExpireSolution(False)

    document.ScheduleSolution(DELAY, GH_Document.GH_ScheduleDelegate(create))


def _input(component: Any, name: str) -> Optional[Any]:
    parameters = getattr(component, "Params", None)
    return None if parameters is None else next((own for own in parameters.Input if own.Name == name), None)


def _value_list(name: str, values: Sequence[str]) -> Any:
    from Grasshopper.Kernel import Special

    made = Special.GH_ValueList()
    made.NickName = name
    made.ListItems.Clear()
    for value in values:
        made.ListItems.Add(Special.GH_ValueListItem(value, f'"{value}"'))
    made.SelectItem(0)
    return made


def _slider(name: str, low: float, high: float, value: float) -> Any:
    from Grasshopper.Kernel import Special
    from System import Decimal

    made = Special.GH_NumberSlider()
    made.NickName = name
    made.Slider.DecimalPlaces = max(0, 2 - math.floor(math.log10(high)))
    made.Slider.Minimum, made.Slider.Maximum = Decimal(low), Decimal(high)
    made.SetSliderValue(Decimal(value))
    return made


def _place_before(made: Any, parameter: Any) -> None:
    """Place an object to the left of an input, when its size on the canvas is known."""
    from System.Drawing import PointF

    made.Attributes.PerformLayout()
    bounds, pivot, place = made.Attributes.Bounds, made.Attributes.Pivot, parameter.Attributes.Pivot
    right, middle = bounds.X + bounds.Width, bounds.Y + 0.5 * bounds.Height
    made.Attributes.Pivot = PointF(pivot.X + place.X - GAP - right, pivot.Y + place.Y - middle)
    made.Attributes.ExpireLayout()
