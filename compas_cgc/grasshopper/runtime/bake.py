"""Baking of geometry to layers of the open Rhino document, with names and user text."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Iterator
from collections.abc import Mapping
from contextlib import contextmanager
from typing import Any

from ...errors import CGCError

__all__ = ["Bakery", "baking", "is_baked"]

OWNER = "cgc baked by"  # user text with the id of the component, which identifies its earlier objects
NOT_FOUND = -1


class Bakery:
    """Writer of objects to a Rhino document.

    Parameters
    ----------
    document
        The document.
    owner
        Id of the baking component.
    """

    def __init__(self, document: Any, owner: str):
        self._document = document
        self._owner = owner
        self.baked: list[str] = []

    def clear(self) -> None:
        """Delete the earlier objects of the component."""
        objects = self._document.Objects
        for earlier in list(objects.FindByUserString(OWNER, self._owner, True) or ()):
            objects.Delete(earlier, True)

    def layer(self, path: str, colour: tuple[int, int, int]) -> int:
        """Return the index of a layer, such as ``CGC Result::Mesh``; create it if necessary."""
        import Rhino
        import System

        layers, parent, known, index = self._document.Layers, None, "", NOT_FOUND
        for name in path.split("::"):
            known = f"{known}::{name}" if known else name
            index = layers.FindByFullPath(known, NOT_FOUND)
            if index == NOT_FOUND:
                made = Rhino.DocObjects.Layer()
                made.Name = name
                made.Color = System.Drawing.Color.FromArgb(*colour)
                if parent is not None:
                    made.ParentLayerId = parent
                index = layers.Add(made)
                if index == NOT_FOUND:
                    raise CGCError(f"Rhino cannot create the layer {known!r}; choose another name")
            parent = layers[index].Id
        return int(index)

    def add(self, kind: str, geometry: Any, layer: int, name: str, text: Mapping[str, str]) -> None:
        """Bake a ``Mesh``, ``Curve`` or ``Point``."""
        import Rhino

        attributes = Rhino.DocObjects.ObjectAttributes()
        attributes.Name, attributes.LayerIndex = name, layer
        for key, value in {**text, OWNER: self._owner}.items():
            attributes.SetUserString(key, value)
        self.baked.append(str(getattr(self._document.Objects, f"Add{kind}")(geometry, attributes)))


def is_baked(ids: Iterable[str]) -> bool:
    """Check whether all objects with these ids are in the open document."""
    import Rhino
    import System

    document = Rhino.RhinoDoc.ActiveDoc
    return document is not None and all(document.Objects.FindId(System.Guid(id)) is not None for id in ids)


@contextmanager
def baking(owner: str) -> Iterator[Bakery]:
    """Bake to the open document as a single undo step.

    Raises
    ------
    CGCError
        If no document is open.
    """
    import Rhino

    document = Rhino.RhinoDoc.ActiveDoc
    if document is None:
        raise CGCError("no Rhino document is open; open one to bake")
    record = document.BeginUndoRecord("Bake CGC")
    try:
        yield Bakery(document, owner)
    finally:
        document.EndUndoRecord(record)
        document.Views.Redraw()
