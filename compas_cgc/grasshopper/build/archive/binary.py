"""Grasshopper's binary form: a chunk as raw deflate, little-endian, without checksums."""

from __future__ import annotations

import struct
import uuid
import zlib
from decimal import Decimal
from typing import Optional

from ....errors import FileError
from .tree import Chunk
from .tree import Item
from .types import BY_CODE
from .types import TYPES
from .types import Type
from .types import Value

__all__ = ["from_bytes", "to_bytes"]

# Limits on untrusted files, above the needs of any definition.
MAX_SIZE = 1 << 28  # inflated size [bytes]
MAX_DEPTH = 64  # levels of nested chunks
# Minimal sizes in bytes: a chunk has a name, an index and two counts; an item has a name, an index, a type and one byte.
SMALLEST_CHUNK = 13
SMALLEST_ITEM = 10


def to_bytes(root: Chunk) -> bytes:
    """Return a chunk as the bytes of a .gh or .ghuser file; the same chunk gives the same bytes.

    Parameters
    ----------
    root
        Root chunk of the file.

    Returns
    -------
    bytes
        Content of the file.

    Examples
    --------
    >>> from compas_cgc.grasshopper.build.archive import chunk
    >>> to_bytes(chunk("Root")) == to_bytes(chunk("Root"))
    True
    """
    deflate = zlib.compressobj(6, zlib.DEFLATED, -15)
    return deflate.compress(b"".join(_chunk_parts(root))) + deflate.flush()


def from_bytes(data: bytes) -> Chunk:
    """Read a chunk from the bytes of a .gh or .ghuser file.

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
    >>> from compas_cgc.grasshopper.build.archive import chunk, to_bytes
    >>> from_bytes(to_bytes(chunk("Root"))).name
    'Root'
    """
    inflate = zlib.decompressobj(-15)
    try:
        plain = inflate.decompress(data, MAX_SIZE)
    except zlib.error as error:
        raise FileError(f"this is not a binary Grasshopper file ({error})") from None
    if not inflate.eof:
        raise FileError("the Grasshopper file is truncated" if not inflate.unconsumed_tail else "the Grasshopper file is too large")
    return _Reader(plain).chunk(0)


class _Reader:
    """Read position in inflated bytes."""

    def __init__(self, data: bytes):
        self.data = data
        self.at = 0

    def take(self, count: int) -> bytes:
        if count < 0 or count > len(self.data) - self.at:
            raise FileError("the Grasshopper file is truncated or damaged")
        self.at += count
        return self.data[self.at - count : self.at]

    def unpack(self, format: str) -> tuple:
        return struct.unpack(format, self.take(struct.calcsize(format)))

    def integer(self) -> int:
        return self.unpack("<i")[0]

    def index(self) -> Optional[int]:
        value = self.integer()
        return None if value == -1 else value

    def count(self, smallest: int) -> int:
        """Return a count after checking that the remaining bytes can hold as many elements."""
        value = self.integer()
        if not 0 <= value <= (len(self.data) - self.at) // smallest:
            raise FileError("the Grasshopper file is truncated or damaged")
        return value

    def text(self) -> str:
        length, shift = 0, 0
        while True:
            byte = self.take(1)[0]
            length |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                break
            if shift > 28:
                raise FileError("the Grasshopper file is damaged: a string has no length")
        try:
            return self.take(length).decode("utf-8")
        except UnicodeDecodeError:
            raise FileError("the Grasshopper file is damaged: a string is not UTF-8") from None

    def chunk(self, depth: int) -> Chunk:
        if depth > MAX_DEPTH:
            raise FileError("the Grasshopper file is damaged: chunks are nested too deeply")
        name, index = self.text(), self.index()
        items, chunks = self.integer(), self.integer()
        room = len(self.data) - self.at
        if items < 0 or chunks < 0 or items * SMALLEST_ITEM + chunks * SMALLEST_CHUNK > room:
            raise FileError("the Grasshopper file is truncated or damaged")
        return Chunk(name, tuple(self.item() for _ in range(items)), tuple(self.chunk(depth + 1) for _ in range(chunks)), index)

    def item(self) -> Item:
        name, index, code = self.text(), self.index(), self.integer()
        if code not in BY_CODE:
            raise FileError(f"the item {name!r} has the unknown type {code}")
        return Item(name, index, BY_CODE[code].name, self.value(BY_CODE[code]))

    def value(self, kind: Type) -> Value:
        if kind.name == "gh_bool":
            return self.take(1) != b"\0"
        if kind.format:
            values = self.unpack(kind.format)
            return values if kind.fields else values[0]
        if kind.name == "gh_string":
            return self.text()
        if kind.name == "gh_guid":
            return uuid.UUID(bytes_le=self.take(16))
        if kind.name == "gh_decimal":
            return _decimal(self.unpack("<4I"))
        if kind.name == "gh_drawing_color":
            number = self.unpack("<I")[0]
            return tuple(number >> shift & 255 for shift in (24, 16, 8, 0))
        if kind.name == "gh_doublearray":
            return self.unpack(f"<{self.count(8)}d")
        return self.take(self.count(1))


def _decimal(words: tuple[int, ...]) -> Decimal:
    low, middle, high, flags = words
    digits = low | middle << 32 | high << 64
    sign = flags >> 31
    return Decimal((sign, tuple(map(int, str(digits))), -(flags >> 16 & 255)))


def _chunk_parts(part: Chunk) -> list[bytes]:
    parts = [_text(part.name), _index(part.index), struct.pack("<ii", len(part.items), len(part.chunks))]
    for entry in part.items:
        kind = TYPES[entry.type]
        parts += [_text(entry.name), _index(entry.index), struct.pack("<i", kind.code), _value(kind, entry.value)]
    for child in part.chunks:
        parts += _chunk_parts(child)
    return parts


def _value(kind: Type, value: Value) -> bytes:
    if kind.format:
        return struct.pack(kind.format, *(value if kind.fields else (value,)))
    if kind.name == "gh_string":
        return _text(value)
    if kind.name == "gh_guid":
        return value.bytes_le
    if kind.name == "gh_decimal":
        sign, digits, exponent = value.as_tuple()
        number = int("".join(map(str, digits)))
        words = (number & 0xFFFFFFFF, number >> 32 & 0xFFFFFFFF, number >> 64, sign << 31 | -exponent << 16)
        return struct.pack("<4I", *words)
    if kind.name == "gh_drawing_color":
        return bytes(reversed(value))
    if kind.name == "gh_doublearray":
        return struct.pack(f"<i{len(value)}d", len(value), *value)
    return struct.pack("<i", len(value)) + value


def _text(value: str) -> bytes:
    data = value.encode("utf-8")
    length, head = len(data), bytearray()
    while length >= 0x80:
        head.append(length & 0x7F | 0x80)
        length >>= 7
    head.append(length)
    return bytes(head) + data


def _index(value: Optional[int]) -> bytes:
    return struct.pack("<i", -1 if value is None else value)
