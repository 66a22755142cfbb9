"""Schema of a component: the inputs and outputs shown by Hops."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional
from typing import Union

__all__ = ["MAX_ITEMS", "Endpoint", "Input", "Output", "icon"]

MAX_ITEMS = 5000  # largest number of curves or points that are located on the mesh one by one
RESULT_TYPES = {
    "Number": "System.Double",
    "Integer": "System.Int32",
    "Boolean": "System.Boolean",
    "Text": "System.String",
    "Mesh": "Rhino.Geometry.Mesh",
    "Point": "Rhino.Geometry.Point3d",
    "Curve": "Rhino.Geometry.Curve",
}


def icon(path: str, colour: str = "#b5482f") -> str:
    """Return an SVG icon with a path in a 24 by 24 view box."""
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" width="24" height="24" viewBox="0 0 24 24">'
        f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="2" stroke-linecap="round" stroke-linejoin="round"/></svg>'
    )


@dataclass(frozen=True)
class Output:
    """An output of a component.

    Parameters
    ----------
    name, nickname, kind, text
        ``kind`` is Grasshopper's name of the type.
    """

    name: str
    nickname: str
    kind: str
    text: str

    def describe(self) -> dict:
        """Return the entry of the description."""
        return {
            "Name": self.name,
            "Nickname": self.nickname,
            "Description": self.text,
            "ParamType": self.kind,
            "ResultType": RESULT_TYPES[self.kind],
        }


@dataclass(frozen=True)
class Input(Output):
    """An input of a component.

    Parameters
    ----------
    default
        Value of an unconnected input: a number, boolean or string.
    many
        Whether the input takes a list.
    most
        Largest number of items.
    optional
        Whether the input may be empty; older versions of Hops ignore this.
    low, high
        Bounds of a number.
    """

    default: Union[float, int, bool, str, None] = None
    many: bool = False
    most: int = 200_000
    optional: bool = False
    low: Optional[float] = None
    high: Optional[float] = None

    def describe(self) -> dict:
        """Return the entry of the description."""
        entry = {**super().describe(), "AtLeast": 0 if self.optional else 1, "AtMost": 2147483647 if self.many else 1, "TreeAccess": False}
        extra = {"Default": self.default, "Minimum": self.low, "Maximum": self.high}
        return {**entry, **{name: value for name, value in extra.items() if value is not None}}


@dataclass(frozen=True)
class Endpoint:
    """A function on the server that is a component in Grasshopper.

    Parameters
    ----------
    uri
        Path of the function, such as ``cgc/dome``.
    name, text, icon
        ``icon`` is SVG.
    inputs, outputs
        Inputs and outputs in the order on the component.
    """

    uri: str
    name: str
    text: str
    icon: str
    inputs: tuple[Input, ...]
    outputs: tuple[Output, ...]

    def describe(self) -> dict:
        """Return the description that ``GET`` returns."""
        return {
            "Uri": f"/{self.uri}",
            "Name": self.name,
            "Nickname": self.name,
            "Description": self.text,
            "Category": "COMPAS CGC",
            "Subcategory": "Solve",
            "CacheKey": None,
            "InputNames": [entry.name for entry in self.inputs],
            "OutputNames": [entry.name for entry in self.outputs],
            "Inputs": [entry.describe() for entry in self.inputs],
            "Outputs": [entry.describe() for entry in self.outputs],
            "Icon": self.icon,
            "Errors": [],
            "Warnings": [],
        }
