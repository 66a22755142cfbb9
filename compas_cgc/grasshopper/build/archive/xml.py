"""XML form of Grasshopper files (.ghx)."""

from __future__ import annotations

import base64
import re
import struct
from collections.abc import Iterator
from decimal import Decimal
from typing import Optional
from xml.etree import ElementTree
from xml.sax.saxutils import escape
from xml.sax.saxutils import quoteattr

from ....errors import FileError
from .tree import Chunk
from .tree import Item
from .tree import item
from .types import BY_CODE
from .types import TYPES
from .types import Value

__all__ = ["from_xml", "to_xml"]

MAX_DEPTH = 64  # levels of nested chunks
NOT_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")
# XML parsers normalise literal carriage returns, but not character references.
ENTITIES = {"\r": "&#13;"}


# Half a step beyond the largest single-precision number, above which rounding gives infinity.
SINGLE_LIMIT = float.fromhex("0x1.ffffffp+127")


def to_xml(root: Chunk) -> bytes:
    """Return a chunk as the bytes of a .ghx file.

    Parameters
    ----------
    root
        Root chunk of the file.

    Returns
    -------
    bytes
        Content of the file, UTF-8.

    Raises
    ------
    FileError
        If a string holds a character that XML cannot represent.

    Examples
    --------
    >>> from compas_cgc.grasshopper.build.archive import chunk
    >>> to_xml(chunk("Root"))[:5]
    b'<?xml'
    """
    lines = ['<?xml version="1.0" encoding="utf-8" standalone="yes"?>', f"<Archive name={quoteattr(root.name)}>"]
    lines += [*_inside(root, "  "), "</Archive>", ""]
    text = "\n".join(lines)
    if NOT_XML.search(text):
        raise FileError("a string holds a control character, which XML cannot represent; write a .gh file instead")
    return text.encode("utf-8")


def from_xml(data: bytes) -> Chunk:
    """Read a chunk from the bytes of a .ghx file.

    Parameters
    ----------
    data
        Content of the file.

    Returns
    -------
    Chunk
        The root.

    Raises
    ------
    FileError
        If the data are truncated, damaged or in another format.

    Examples
    --------
    >>> from compas_cgc.grasshopper.build.archive import chunk, to_xml
    >>> from_xml(to_xml(chunk("Root"))).name
    'Root'
    """
    if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
        raise FileError("the Grasshopper file declares XML entities, which Grasshopper does not support")
    try:
        root = ElementTree.fromstring(data)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise FileError(f"the Grasshopper file is truncated or damaged: {error}") from None
    if root.tag != "Archive":
        raise FileError(f"a .ghx file must begin with <Archive>, not with <{root.tag}>")
    return _chunk(root, 0)


def _inside(part: Chunk, indent: str) -> Iterator[str]:
    if part.items:
        yield f'{indent}<items count="{len(part.items)}">'
        for entry in part.items:
            kind = TYPES[entry.type]
            head = f'{indent}  <item {_heading(entry.name, entry.index)} type_name="{kind.name}" type_code="{kind.code}">'
            yield f"{head}{_value_text(entry)}</item>"
        yield f"{indent}</items>"
    if part.chunks:
        yield f'{indent}<chunks count="{len(part.chunks)}">'
        for child in part.chunks:
            yield f"{indent}  <chunk {_heading(child.name, child.index)}>"
            yield from _inside(child, indent + "    ")
            yield f"{indent}  </chunk>"
        yield f"{indent}</chunks>"


def _heading(name: str, index: Optional[int]) -> str:
    return f"name={quoteattr(name)}" + ("" if index is None else f' index="{index}"')


def _value_text(entry: Item) -> str:
    kind, value = TYPES[entry.type], entry.value
    if kind.fields:
        single = kind.format.endswith("f")
        return "".join(f"<{name}>{_number(x, single)}</{name}>" for name, x in zip(kind.fields, value))
    if kind.name == "gh_bool":
        return "true" if value else "false"
    if kind.name == "gh_string":
        return escape(value, ENTITIES)
    if kind.name == "gh_drawing_color":
        return f"<ARGB>{';'.join(map(str, value))}</ARGB>"
    if kind.name == "gh_doublearray":
        value = struct.pack(f"<{len(value)}d", *value)
    if isinstance(value, bytes):
        tag = "bitmap" if kind.name == "gh_drawing_bitmap" else "stream"
        return f'<{tag} length="{len(value)}">{base64.b64encode(value).decode("ascii")}</{tag}>'
    if isinstance(value, Decimal):
        return format(value, "f")
    return _number(value, kind.name == "gh_single") if isinstance(value, float) else str(value)


def _number(value: float, single: bool) -> str:
    """Return the shortest string that is read back as the same number."""
    if value != value or value in (float("inf"), -float("inf")):
        return {"nan": "NaN", "inf": "Infinity", "-inf": "-Infinity"}[repr(value)]
    if not isinstance(value, float) or not single:
        return repr(value)
    texts = (f"{value:.{digits}g}" for digits in range(1, 10))
    return next(text for text in texts if abs(float(text)) < SINGLE_LIMIT and struct.pack("<f", float(text)) == struct.pack("<f", value))


def _chunk(element: ElementTree.Element, depth: int) -> Chunk:
    if depth > MAX_DEPTH:
        raise FileError("the Grasshopper file is damaged: chunks are nested too deeply")
    items = tuple(_item(child) for group in element.findall("items") for child in group.findall("item"))
    chunks = tuple(_chunk(child, depth + 1) for group in element.findall("chunks") for child in group.findall("chunk"))
    return Chunk(element.get("name", ""), items, chunks, _index(element))


def _item(element: ElementTree.Element) -> Item:
    name = element.get("name", "")
    try:
        kind = BY_CODE[int(element.get("type_code", ""))]
    except (KeyError, ValueError):
        raise FileError(f"the item {name!r} has the unknown type {element.get('type_code')!r}") from None
    try:
        return item(name, kind.name, _value(element, kind.name), _index(element))
    except (ValueError, ArithmeticError, struct.error) as error:
        raise FileError(f"the item {name!r} is damaged: {error}") from None


def _value(element: ElementTree.Element, name: str) -> Value:
    kind, text = TYPES[name], element.text or ""
    if kind.fields:
        read = int if "i" in kind.format else float
        return tuple(read(element.findtext(field, "")) for field in kind.fields)
    if name == "gh_bool":
        return {"true": True, "false": False}.get(text.strip().lower(), text)
    if name == "gh_string":
        return text
    if name == "gh_drawing_color":
        return tuple(int(part) for part in element.findtext("ARGB", "").split(";"))
    if name in ("gh_bytearray", "gh_drawing_bitmap", "gh_doublearray"):
        data = base64.b64decode("".join(element.findtext("bitmap" if name == "gh_drawing_bitmap" else "stream", "").split()), validate=True)
        return struct.unpack(f"<{len(data) // 8}d", data) if name == "gh_doublearray" else data
    if name in ("gh_single", "gh_double"):
        return float(text)
    return text.strip() if name in ("gh_guid", "gh_decimal") else int(text)


def _index(element: ElementTree.Element) -> Optional[int]:
    text = element.get("index")
    try:
        return None if text is None else int(text)
    except ValueError:
        raise FileError(f"the index {text!r} is not an integer") from None
