"""Nodes: the objects of a canvas and their wires, as plain data."""

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

# Where an input comes from: "key" of an object with one output, or "key.output"; several in a tuple.
Wires = Mapping[str, Union[str, tuple[str, ...]]]


@dataclass(frozen=True)
class Node:
    """Base of all objects; the key is unique on the canvas."""

    key: str


@dataclass(frozen=True)
class Slider(Node):
    """A number slider; without digits it gives whole numbers."""

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
    """A panel: a text to give, or a place to read what comes in."""

    name: str
    text: str = ""
    source: str = ""
    size: tuple[int, int] = (200, 60)
    whole: bool = False  # its lines are one text


@dataclass(frozen=True)
class ValueList(Node):
    """A drop-down list of texts, the first one chosen."""

    name: str
    values: tuple[str, ...]


@dataclass(frozen=True)
class Parameter(Node):
    """A floating parameter that the user fills, of a kind such as ``Mesh``."""

    name: str
    kind: str


@dataclass(frozen=True)
class Script(Node):
    """One of our components."""

    bundle: str  # key of the bundle
    wires: Wires = field(default_factory=dict)
    hidden: bool = False  # its geometry is not drawn


@dataclass(frozen=True)
class Hops(Node):
    """Grasshopper's own component for a function of our server."""

    uri: str  # such as cgc/dome
    wires: Wires = field(default_factory=dict)


@dataclass(frozen=True)
class Note(Node):
    """A text on the canvas, above all objects."""

    text: str
    size: float = 14.0


@dataclass(frozen=True)
class Group(Node):
    """A coloured ground behind objects."""

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
        What it shows, in a sentence or two.
    nodes
        Objects; those that share a column are stacked in this order.
    rhino
        Oldest Rhino that it is for.

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
