"""Layered layout: objects in columns from left to right along the wires."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from ..component_manifest import Bundle
from .nodes import Definition
from .nodes import Group
from .nodes import Hops
from .nodes import Node
from .nodes import Note
from .nodes import Panel
from .nodes import Parameter
from .nodes import Script
from .nodes import Slider
from .nodes import ValueList
from .ports import input_names
from .ports import output_names
from .ports import sources_of

__all__ = ["Box", "layout", "port_boxes"]

COLUMN_GAP = 70.0  # all lengths in pixels
ROW_GAP = 18.0
PORT = 20.0  # height of an input or output
ICON = 28.0  # width of a component between its inputs and outputs
LETTER = 6.5  # mean width of a character
NOTE_LINE = 1.6  # line height of a note, relative to its font size


class Box(NamedTuple):
    """A rectangle on the canvas, y downwards [pixel]."""

    x: float
    y: float
    width: float
    height: float

    @property
    def centre(self) -> tuple[float, float]:
        """Centre of the rectangle."""
        return self.x + self.width / 2, self.y + self.height / 2


def layout(definition: Definition, bundles: Mapping[str, Bundle]) -> dict[str, Box]:
    """Return the rectangle of every object except groups."""
    notes = [node for node in definition.nodes if isinstance(node, Note)]
    nodes = {node.key: node for node in definition.nodes if not isinstance(node, (Note, Group))}
    wired = {wire.partition(".")[0] for node in nodes.values() for wires in sources_of(node).values() for wire in wires}
    alone = {key: node for key, node in nodes.items() if isinstance(node, Script) and key not in wired and not sources_of(node)}
    nodes = {key: node for key, node in nodes.items() if key not in alone}
    columns = _columns(nodes)
    boxes: dict[str, Box] = {}
    y = 0.0
    for note in notes:
        lines = note.text.split("\n")
        boxes[note.key] = Box(0.0, y, 0.62 * note.size * max(map(len, lines)), NOTE_LINE * note.size * len(lines))
        y += boxes[note.key].height + ROW_GAP
    sizes = {key: _size(node, bundles) for key, node in nodes.items()}
    places = _column_places(columns, sizes, wired)
    top = y + ROW_GAP
    for key, node in alone.items():
        # Components without wires are placed to the left of the others.
        width, height = _size(node, bundles)
        boxes[key] = _free(Box(-COLUMN_GAP - width, top, width, height), boxes)
    # Objects with inputs are placed beside their sources first, then the sources beside the inputs.
    for key in sorted(columns, key=columns.__getitem__):
        sources = [wire.partition(".")[0] for wires in sources_of(nodes[key]).values() for wire in wires]
        if sources:
            wanted = min((boxes[other].y for other in sources if other in boxes), default=top)
            boxes[key] = _free(Box(places[columns[key]][0], wanted, *sizes[key]), boxes)
    for key in nodes:
        if key not in boxes:
            x, width = places[columns[key]]
            fed = [y for other in nodes.values() for y in _fed_heights(key, other, boxes, bundles)]
            wanted = max(top, min(fed, default=top) - sizes[key][1] / 2)
            boxes[key] = _free(Box(x + width - sizes[key][0], wanted, *sizes[key]), boxes)
    return boxes


def _column_places(columns: Mapping[str, int], sizes: Mapping[str, tuple[float, float]], feeding: set[str]) -> list[tuple[float, float]]:
    """Return the left side and width of every column; objects without outgoing wires may extend into the next column."""
    places, x = [], 0.0
    for column in range(max(columns.values(), default=-1) + 1):
        members = [key for key, own in columns.items() if own == column]
        width = max(sizes[key][0] for key in [key for key in members if key in feeding] or members)
        places.append((x, width))
        x += width + COLUMN_GAP
    return places


def _free(box: Box, boxes: Mapping[str, Box]) -> Box:
    """Return the box, moved down until it overlaps no other."""
    while True:
        near = [o for o in boxes.values() if o.x < box.x + box.width and box.x < o.x + o.width]
        hit = [o for o in near if o.y < box.y + box.height + ROW_GAP and box.y < o.y + o.height + ROW_GAP]
        if not hit:
            return box
        box = box._replace(y=max(o.y + o.height for o in hit) + ROW_GAP)


def _fed_heights(key: str, node: Node, boxes: Mapping[str, Box], bundles: Mapping[str, Bundle]) -> list[float]:
    """Return the vertical positions of the inputs that an object feeds."""
    if node.key not in boxes or not isinstance(node, (Script, Hops)):
        return []
    names, ports = input_names(node, bundles), port_boxes(node, boxes[node.key], bundles)[0]
    fed = [name for name, wires in sources_of(node).items() if key in (wire.partition(".")[0] for wire in wires)]
    return [ports[names.index(name)].centre[1] for name in fed]


def port_boxes(node: Node, box: Box, bundles: Mapping[str, Bundle]) -> tuple[list[Box], list[Box]]:
    """Return the rectangles of the inputs and of the outputs of an object."""
    sides = (input_names(node, bundles), output_names(node, bundles))
    left, right = (_text_width(names) for names in sides)
    return (
        [Box(box.x + 2, box.y + 2 + y, left, h) for y, h in _rows(len(sides[0]), box.height - 4)],
        [Box(box.x + box.width - 2 - right, box.y + 2 + y, right, h) for y, h in _rows(len(sides[1]), box.height - 4)],
    )


def _columns(nodes: Mapping[str, Node]) -> dict[str, int]:
    """Return the column of each object: the longest path from a source; sources are placed just before their first target."""
    before = {key: [wire.partition(".")[0] for wires in sources_of(node).values() for wire in wires] for key, node in nodes.items()}
    depth: dict[str, int] = {}

    def column(key: str) -> int:
        if key not in depth:
            depth[key] = 1 + max(map(column, before[key]), default=-1)
        return depth[key]

    for key in nodes:
        column(key)
    for key, own in before.items():
        fed = [depth[other] for other, sources in before.items() if key in sources]
        if not own and fed:
            depth[key] = min(fed) - 1
    return depth


def _size(node: Node, bundles: Mapping[str, Bundle]) -> tuple[float, float]:
    if isinstance(node, Panel):
        return node.size
    if isinstance(node, (Script, Hops)):
        sides = (input_names(node, bundles), output_names(node, bundles))
        return sum(map(_text_width, sides)) + ICON + 4, PORT * max(2, *map(len, sides)) + 4
    if isinstance(node, ValueList):
        return 130.0, 22.0
    if isinstance(node, Parameter):
        return max(50.0, _text_width([node.name])), 20.0
    return (200.0, 20.0) if isinstance(node, Slider) else (110.0, 22.0)


def _text_width(names: list[str]) -> float:
    return max((LETTER * len(name) + 12 for name in names), default=8.0)


def _rows(count: int, height: float) -> list[tuple[float, float]]:
    return [(i * height / count, height / count) for i in range(count)]
