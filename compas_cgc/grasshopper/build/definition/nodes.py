"""Nodes: the objects and wires of a canvas as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from dataclasses import field
from typing import Union

__all__ = [
    "Button",
    "Definition",
    "Group",
    "Hops",
    "Node",
    "Note",
    "Panel",
    "Parameter",
    "Script",
    "Slider",
    "Toggle",
    "ValueList",
    "Wires",
]

# Source of an input: "key" of an object with one output, or "key.output"; a tuple for several.
Wires = Mapping[str, Union[str, tuple[str, ...]]]


@dataclass(frozen=True)
class Node:
    """Base of all objects; the key is unique on the canvas."""

    key: str


@dataclass(frozen=True)
class Slider(Node):
    """A number slider; without digits its values are integers."""

    name: str
    value: float
    low: float
    high: float
    digits: int = 3


@dataclass(frozen=True)
class Toggle(Node):
    """A boolean toggle."""

    name: str
    value: bool = False


@dataclass(frozen=True)
class Button(Node):
    """A button, true while it is pressed."""

    name: str


@dataclass(frozen=True)
class Panel(Node):
    """A panel with a text, or one that shows its source."""

    name: str
    text: str = ""
    source: str = ""
    size: tuple[int, int] = (200, 60)
    whole: bool = False  # whether its lines form one text


@dataclass(frozen=True)
class ValueList(Node):
    """A drop-down list of texts, the first one chosen."""

    name: str
    values: tuple[str, ...]


@dataclass(frozen=True)
class Parameter(Node):
    """A floating parameter set by the user, of a type such as ``Mesh``."""

    name: str
    kind: str


@dataclass(frozen=True)
class Script(Node):
    """One of our components."""

    bundle: str  # key of the bundle
    wires: Wires = field(default_factory=dict)
    hidden: bool = False  # whether its preview is disabled


@dataclass(frozen=True)
class Hops(Node):
    """A Hops component for a function of the server."""

    uri: str  # path of the function, such as cgc/dome
    wires: Wires = field(default_factory=dict)


@dataclass(frozen=True)
class Note(Node):
    """A text on the canvas, above all objects."""

    text: str
    size: float = 14.0


@dataclass(frozen=True)
class Group(Node):
    """A coloured group of objects."""

    name: str
    members: tuple[str, ...]


@dataclass(frozen=True)
class Definition:
    """A canvas.

    Parameters
    ----------
    name
        Name of the file.
    title
        Headline on the canvas.
    description
        Description in one or two sentences.
    nodes
        Objects; objects in the same column are stacked in this order.
    rhino
        Oldest supported version of Rhino.

    Examples
    --------
    >>> from compas_cgc.grasshopper.build.definition import EXAMPLES
    >>> definition = EXAMPLES[0]
    """

    name: str
    title: str
    description: str
    nodes: tuple[Node, ...]
    rhino: int = 8
