"""Items and chunks of sliders, panels and other standard objects."""

from __future__ import annotations

from collections.abc import Sequence

from ..archive import Chunk
from ..archive import Item
from ..archive import chunk
from ..archive import item
from .layout import Box
from .nodes import Button
from .nodes import Node
from .nodes import Note
from .nodes import Panel
from .nodes import Parameter
from .nodes import Slider
from .nodes import Toggle
from .nodes import ValueList

__all__ = ["widget"]

PANEL_COLOUR = (255, 255, 250, 90)


def widget(node: Node, box: Box) -> tuple[str, str, list[Item], list[Chunk]]:
    """Return type, name, items and chunks of an object in a rectangle."""
    if isinstance(node, Slider):
        return "slider", "Number Slider", [], [_attributes(box), _slider(node)]
    if isinstance(node, Toggle):
        return "toggle", "Boolean Toggle", [item("ToggleValue", "gh_bool", node.value)], [_attributes(box, pivot=False)]
    if isinstance(node, Button):
        items = [item("ExpressionNormal", "gh_string", "False"), item("ExpressionPressed", "gh_string", "True")]
        return "button", "Button", items, [_attributes(box, pivot=False)]
    if isinstance(node, Panel):
        items = [item("ScrollRatio", "gh_double", 0.0), item("UserText", "gh_string", node.text)]
        margins = [item(f"Margin{side}", "gh_int32", 0) for side in ("Left", "Right", "Top")]
        return "panel", "Panel", items, [_attributes(box, margins), _panel(multiline=node.whole or not node.text)]
    if isinstance(node, ValueList):
        items = [item("ListCount", "gh_int32", len(node.values)), item("ListMode", "gh_int32", 1)]
        entries = [_entry(i, value) for i, value in enumerate(node.values)]
        return "list", "Value List", items, [_attributes(box), *entries]
    if isinstance(node, Parameter):
        return node.kind, node.kind, [], [_attributes(box)]
    if isinstance(node, Note):
        return "scribble", "Scribble", _note(node, box), [_attributes(box)]
    raise TypeError(f"{type(node).__name__} is not a widget")


def _slider(node: Slider) -> Chunk:
    return chunk(
        "Slider",
        [
            item("Digits", "gh_int32", node.digits),
            item("GripDisplay", "gh_int32", 1),
            item("Interval", "gh_int32", 0 if node.digits else 1),
            item("Max", "gh_double", node.high),
            item("Min", "gh_double", node.low),
            item("SnapCount", "gh_int32", 0),
            item("Value", "gh_double", node.value),
        ],
    )


def _panel(multiline: bool) -> Chunk:
    # Without multiline, Grasshopper outputs each line as a separate value.
    flags = {"DrawIndices": False, "DrawPaths": False, "Multiline": multiline, "SpecialCodes": False, "Stream": False, "Wrap": True}
    items = [item("Colour", "gh_drawing_color", PANEL_COLOUR), *(item(name, "gh_bool", value) for name, value in flags.items())]
    return chunk("PanelProperties", items)


def _entry(index: int, value: str) -> Chunk:
    items = [
        item("Expression", "gh_string", f'"{value}"'),
        item("Name", "gh_string", value),
        item("Selected", "gh_bool", index == 0),
    ]
    return chunk("ListItem", items, index=index)


def _note(node: Note, box: Box) -> list[Item]:
    right, bottom = box.x + box.width, box.y + box.height
    corners = {"Ca": (box.x, box.y), "Cb": (right, box.y), "Cc": (right, bottom), "Cd": (box.x, bottom)}
    return [
        item("Bold", "gh_bool", False),
        item("Font", "gh_string", "Arial"),
        item("Italic", "gh_bool", False),
        item("Size", "gh_single", node.size),
        item("Text", "gh_string", node.text),
        *(item(name, "gh_drawing_pointf", corner) for name, corner in corners.items()),
    ]


def _attributes(box: Box, more: Sequence[Item] = (), pivot: bool = True) -> Chunk:
    items = [item("Bounds", "gh_drawing_rectanglef", box), *more]
    return chunk("Attributes", [*items, item("Pivot", "gh_drawing_pointf", box[:2])] if pivot else items)
