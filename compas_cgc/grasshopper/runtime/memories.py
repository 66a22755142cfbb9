"""Memories: what the components on open canvases remember from one run to the next."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any
from typing import Generic
from typing import Optional
from typing import TypeVar

__all__ = ["Memories"]

Memory = TypeVar("Memory")


@dataclass(frozen=True, eq=False)
class _Entry(Generic[Memory]):
    component: Any
    run: int  # within a solution: several meshes on one wire make several runs
    memory: Memory
    unwatch: Callable[[], object]  # end the watch over the document


class Memories(Generic[Memory]):
    """A memory for each component and run of it within a solution.

    Ids do not tell components apart: a definition that is open twice, or pasted with its ids, has each of them twice.

    Parameters
    ----------
    forget
        Called with a memory when it is dropped: on a reset, or because its component was deleted or its document closed.
    """

    def __init__(self, forget: Callable[[Memory], object]):
        self._forget = forget
        self._entries: list[_Entry[Memory]] = []

    def of(self, component: Any) -> Optional[Memory]:
        """Return what a component remembers, or None."""
        run = _run_of(component)
        # Rhino's objects come in a new wrapper each time, which are equal but not the same.
        return next((entry.memory for entry in self._entries if entry.run == run and entry.component == component), None)

    def keep(self, component: Any, memory: Memory) -> Memory:
        """Remember something until the component is deleted or its document closed, and return it."""
        for entry in [entry for entry in self._entries if entry.component.OnPingDocument() is None]:
            self._drop(entry)
        watch = _when_closed(component, lambda: self.drop_all(component))
        self._entries.append(_Entry(component, _run_of(component), memory, watch))
        return memory

    def drop(self, component: Any) -> None:
        """Forget what a component remembers of this run."""
        run = _run_of(component)
        for entry in [entry for entry in self._entries if entry.run == run and entry.component == component]:
            self._drop(entry)

    def drop_all(self, component: Any) -> None:
        """Forget what a component remembers of all its runs."""
        for entry in [entry for entry in self._entries if entry.component == component]:
            self._drop(entry)

    def _drop(self, entry: _Entry[Memory]) -> None:
        self._entries = [other for other in self._entries if other is not entry]
        entry.unwatch()
        self._forget(entry.memory)


def _run_of(component: Any) -> int:
    return int(getattr(component, "RunCount", 1))


def _when_closed(component: Any, callback: Callable[[], object]) -> Callable[[], object]:
    """Call a function when the document of a component is closed, which nothing that is scheduled there outlives.

    Returns
    -------
    Callable
        Ends the watch.
    """
    import Grasshopper

    instances = getattr(Grasshopper, "Instances", None)
    if instances is None:
        return lambda: None
    documents, document = instances.DocumentServer, component.OnPingDocument()

    def removed(sender: Any, closed: Any) -> None:
        if closed == document:
            callback()

    def unwatch() -> None:
        documents.DocumentRemoved -= removed

    documents.DocumentRemoved += removed
    return unwatch
