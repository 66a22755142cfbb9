"""Archive tree: the chunks and items of Grasshopper files."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from dataclasses import field
from typing import NamedTuple
from typing import Optional

from ....errors import FileError
from .types import TYPES
from .types import Value

__all__ = ["Chunk", "Item", "chunk", "item"]


class Item(NamedTuple):
    """A named value.

    Parameters
    ----------
    name
        Name of the item.
    index
        Position in a numbered list such as ``InputId``.
    type
        A name in :data:`compas_cgc.grasshopper.build.archive.TYPES`.
    value
        Normalised value, as read from a file.

    Examples
    --------
    >>> from compas_cgc.grasshopper.build.archive import item
    >>> item("Count", "gh_int32", 3).value
    3
    """

    name: str
    index: Optional[int]  # type: ignore[assignment]  # of a numbered list such as ``InputId``; hides that of tuples
    type: str  # a name in :data:`compas_cgc.grasshopper.build.archive.TYPES`
    value: Value


@dataclass(frozen=True)
class Chunk:
    """Named items and child chunks; items are sorted in the order of Grasshopper.

    Parameters
    ----------
    name
        Name, case-sensitive.
    items
        Items, unique by name and index.
    chunks
        Child chunks, unique by name and index, in any order.
    index
        Position in a numbered list such as ``Object``.

    Raises
    ------
    FileError
        If a name and index occur twice.

    Examples
    --------
    >>> from compas_cgc.grasshopper.build.archive import chunk, item
    >>> chunk("Header", [item("Name", "gh_string", "dome")]).name
    'Header'
    """

    name: str
    items: tuple[Item, ...] = ()
    chunks: tuple[Chunk, ...] = ()
    index: Optional[int] = None
    _items: dict[tuple, Item] = field(init=False, repr=False, compare=False)
    _chunks: dict[tuple, Chunk] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        ordered = sorted(self.items, key=lambda entry: (entry.name, -1 if entry.index is None else entry.index))
        object.__setattr__(self, "items", tuple(ordered))
        object.__setattr__(self, "chunks", tuple(self.chunks))
        object.__setattr__(self, "_items", _unique(self.name, self.items))
        object.__setattr__(self, "_chunks", _unique(self.name, self.chunks))

    def has(self, name: str, index: Optional[int] = None) -> bool:
        """Check whether there is an item of this name."""
        return (name, index) in self._items

    def get(self, name: str, index: Optional[int] = None, default: Value = None) -> Value:
        """Return the value of an item, or the default."""
        found = self._items.get((name, index))
        return default if found is None else found.value

    def child(self, name: str, index: Optional[int] = None) -> Optional[Chunk]:
        """Return a child chunk, or None."""
        return self._chunks.get((name, index))

    def part(self, name: str, index: Optional[int] = None) -> Chunk:
        """Return a required child chunk.

        Raises
        ------
        FileError
            If the child chunk does not exist.
        """
        found = self.child(name, index)
        if found is None:
            raise FileError(f"the chunk {self.name!r} has no chunk {name!r}")
        return found

    def children(self, name: str) -> list[Chunk]:
        """Return the numbered child chunks with a name."""
        return [part for part in self.chunks if part.name == name]


def item(name: str, type: str, value: object, index: Optional[int] = None) -> Item:
    """Return an item with its value normalised to the form read from a file.

    Parameters
    ----------
    name
        Name of the item.
    type
        Name of the type, such as ``"gh_int32"``.
    value
        Value of the item.
    index
        Position, if there are several items with this name.

    Returns
    -------
    Item
        The item with its normalised value.

    Raises
    ------
    FileError
        If the value does not fit the type.

    Examples
    --------
    >>> item("Name", "gh_string", "dome").value
    'dome'
    """
    if type not in TYPES:
        raise FileError(f"{type!r} is not a type of Grasshopper files")
    try:
        return Item(name, index, type, TYPES[type].clean(value))
    except (TypeError, ValueError, OverflowError, ArithmeticError) as error:
        raise FileError(f"the item {name!r} cannot hold {value!r} as {type}: {error}") from None


def chunk(name: str, items: Iterable[Item] = (), chunks: Iterable[Chunk] = (), index: Optional[int] = None) -> Chunk:
    """Return a chunk from iterables of items and chunks.

    Parameters
    ----------
    name
        Name of the chunk.
    items
        Items of the chunk.
    chunks
        Child chunks.
    index
        Position, if there are several chunks with this name.

    Returns
    -------
    Chunk
        The chunk with tuples of both.

    Examples
    --------
    >>> chunk("Header", index=2).index
    2
    """
    return Chunk(name, tuple(items), tuple(chunks), index)


def _unique(name: str, parts: tuple) -> dict:
    found = {(part.name, part.index): part for part in parts}
    if len(found) != len(parts):
        keys = [(part.name, part.index) for part in parts]
        twice = next(key for key in keys if keys.count(key) > 1)
        where = twice[0] if twice[1] is None else f"{twice[0]} {twice[1]}"
        raise FileError(f"the chunk {name!r} holds {where!r} twice")
    return found
