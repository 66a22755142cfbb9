"""Picture of a definition as SVG, drawn from its archive."""

from __future__ import annotations

from collections.abc import Iterator
from uuid import UUID
from xml.sax.saxutils import escape

from ..archive import Chunk
from ..archive.rules import walk
from ..guids import COMPONENT_TYPES

__all__ = ["definition_svg"]

MARGIN = 30.0
KINDS = {guid: name for name, guid in COMPONENT_TYPES.items()}
STYLE = (
    "text{font-family:Arial,Helvetica,sans-serif;font-size:11px;fill:#1a1a1a}.m{text-anchor:middle}.r{text-anchor:end}"
    ".c{fill:#e3e3e1;stroke:#444}.p{fill:#fffa5a;fill-opacity:.55;stroke:#998f20}.w{fill:none;stroke:#555;stroke-width:1.8}"
    ".g{fill:#9db7bf;fill-opacity:.28}.k{fill:#333}.k+text{fill:#fff}"
)


def definition_svg(root: Chunk) -> str:
    """Return a picture of a definition as SVG, drawn from its objects, bounds and wires.

    Parameters
    ----------
    root
        Root chunk of a definition, from :func:`compas_cgc.grasshopper.build.archive.read_archive`.

    Returns
    -------
    str
        Text of the SVG file.

    Examples
    --------
    >>> definition_svg(read_archive("first_dome.gh"))  # doctest: +SKIP
    """
    objects = [(KINDS.get(part.get("GUID"), "parameter"), part.part("Container")) for part in _objects(root)]
    places: dict[UUID, tuple] = {}
    for _, container in objects:
        for part in walk(container):
            attributes = part.child("Attributes")
            if attributes is not None and attributes.has("Bounds"):
                places[part.get("InstanceGuid")] = attributes.get("Bounds")
    boxes = list(places.values())
    left, top = min(box[0] for box in boxes), min(box[1] for box in boxes)
    right, bottom = max(box[0] + box[2] for box in boxes), max(box[1] + box[3] for box in boxes)
    view = f"{left - MARGIN:g} {top - MARGIN:g} {right - left + 2 * MARGIN:g} {bottom - top + 2 * MARGIN:g}"
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{view}">', f"<style>{STYLE}</style>"]
    lines.append(f'<rect x="{left - MARGIN:g}" y="{top - MARGIN:g}" width="100%" height="100%" fill="#fff"/>')
    for kind, container in objects:
        if kind == "group":
            lines += _group(container, places)
    for _, container in objects:
        lines += _wires(container, places)
    for kind, container in objects:
        if kind != "group":
            lines += _drawn(kind, container)
    return "\n".join([*lines, "</svg>", ""])


def _objects(root: Chunk) -> list[Chunk]:
    return root.part("Definition").part("DefinitionObjects").children("Object")


def _wires(container: Chunk, places: dict) -> Iterator[str]:
    for part in walk(container):
        for i in range(part.get("SourceCount", default=0)):
            start, end = places[part.get("Source", i)], places[part.get("InstanceGuid")]
            x, y, u, v = start[0] + start[2], start[1] + start[3] / 2, end[0], end[1] + end[3] / 2
            bend = max(30.0, abs(u - x) / 2)
            yield f'<path class="w" d="M{x:.1f} {y:.1f}C{x + bend:.1f} {y:.1f} {u - bend:.1f} {v:.1f} {u:.1f} {v:.1f}"/>'


def _group(container: Chunk, places: dict) -> Iterator[str]:
    boxes = [places[container.get("ID", i)] for i in range(container.get("ID_Count"))]
    left, top = min(box[0] for box in boxes) - 9, min(box[1] for box in boxes) - 9
    right, bottom = max(box[0] + box[2] for box in boxes) + 9, max(box[1] + box[3] for box in boxes) + 9
    yield _rect("g", (left, top, right - left, bottom - top), 8)


def _drawn(kind: str, container: Chunk) -> Iterator[str]:
    box = container.part("Attributes").get("Bounds")
    x, y, width, height = box
    middle = (x + width / 2, y + height / 2 + 4)
    name = container.get("NickName") or container.get("Name")
    if kind == "scribble":
        size = container.get("Size")
        for i, line in enumerate(container.get("Text").split("\n")):
            yield f'<text x="{x:g}" y="{y + size * (1.1 + 1.6 * i):g}" style="font-size:{size:g}px">{escape(line)}</text>'
    elif kind == "panel":
        yield _rect("p", box)
        for i, line in enumerate((container.get("UserText") or name).split("\n")[: max(1, int(height // 17))]):
            yield _text(x + 5, y + 14 + 17 * i, line)
    elif kind in ("script", "hops"):
        yield from _component(container, box)
    elif kind == "slider":
        slider = container.part("Slider")
        value = f"{slider.get('Value'):.{slider.get('Digits')}f}"
        yield _rect("c", box, 3)
        yield _text(x + 5, middle[1], name)
        yield _text(x + width - 6, middle[1], f"◇ {value}", "r")
    else:
        shown = {"toggle": str(container.get("ToggleValue")), "list": "▾ " + _chosen(container), "button": "▣"}.get(kind, "")
        yield _rect("c", box, 3)
        yield _text(x + 5, middle[1], name)
        yield _text(x + width - 6, middle[1], shown, "r")


def _chosen(container: Chunk) -> str:
    return next((entry.get("Name") for entry in container.children("ListItem") if entry.get("Selected")), "")


def _component(container: Chunk, box: tuple) -> Iterator[str]:
    x, y, width, height = box
    yield _rect("c", box, 5)
    data = container.part("ParameterData")
    left, right = x + 2, x + width - 2
    for side in ("Input", "Output"):
        for part in data.children(f"{side}Param"):
            u, v, w, h = part.part("Attributes").get("Bounds")
            left, right = (max(left, u + w), right) if side == "Input" else (left, min(right, u))
            yield _text(u + 4 if side == "Input" else u + w - 4, v + h / 2 + 4, part.get("NickName"), "" if side == "Input" else "r")
    yield _rect("k", (left, y + 3, right - left, height - 6), 3)
    turn = f"{(left + right) / 2 + 4:g} {y + height / 2:g}"
    yield f'<text class="m" transform="translate({turn}) rotate(-90)">{escape(container.get("NickName"))}</text>'


def _rect(kind: str, box: tuple, radius: float = 0) -> str:
    x, y, width, height = box
    return f'<rect class="{kind}" x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="{radius:g}"/>'


def _text(x: float, y: float, text: str, kind: str = "") -> str:
    return f'<text x="{x:g}" y="{y:g}"{f" class={chr(34)}{kind}{chr(34)}" if kind else ""}>{escape(text)}</text>'
