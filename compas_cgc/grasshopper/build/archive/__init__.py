"""Grasshopper archives without Grasshopper: definitions and user objects, binary and XML."""

from __future__ import annotations

from .binary import from_bytes
from .binary import to_bytes
from .files import read_archive
from .files import write_archive
from .rules import definition_problems
from .tree import Chunk
from .tree import Item
from .tree import chunk
from .tree import item
from .types import TYPES
from .xml import from_xml
from .xml import to_xml

__all__ = [
    "TYPES",
    "Chunk",
    "Item",
    "chunk",
    "definition_problems",
    "from_bytes",
    "from_xml",
    "item",
    "read_archive",
    "to_bytes",
    "to_xml",
    "write_archive",
]
