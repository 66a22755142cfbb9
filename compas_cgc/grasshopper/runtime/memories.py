"""Memories: state of the components on open canvases between runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any
from typing import Generic
from typing import Optional
from typing import TypeVar

__all__ = ["Memories", "run_of"]

Memory = TypeVar("Memory")


@dataclass(eq=False)
class _Entry(Generic[Memory]):
    component: Any
    run: int  # index within a solution, as several items on a wire cause several runs
    memory: Memory
    unwatch: Callable[[], object]  # stops watching the document
    solution: int = 0  # the latest solution with this run


@dataclass(eq=False)
class _Solutions:
    component: Any
    number: int = 0  # number of the current solution
    run: int = 0  # latest run


class Memories(Generic[Memory]):
    """State for each component and each of its runs within a solution.

    Component ids are not unique: a definition can be open twice, or be pasted with its ids.

    Parameters
    ----------
    forget
        Called with a state when it is dropped: on a reset, or when its branch or component is deleted or its document closed.
    """

    def __init__(self, forget: Callable[[Memory], object]):
        self._forget = forget
        self._entries: list[_Entry[Memory]] = []
        self._solutions: list[_Solutions] = []

    def of(self, component: Any) -> Optional[Memory]:
        """Return the state of a component, or None."""
        entry = self._entry(component)
        return None if entry is None else entry.memory

    def keep(self, component: Any, memory: Memory) -> Memory:
        """Store the state of a component until it is deleted or its document closed, and return the state."""
        for entry in [entry for entry in self._entries if entry.component.OnPingDocument() is None]:
            self._drop(entry)
        watch = _when_closed(component, lambda: self.drop_all(component))
        solution = next((own.number for own in self._solutions if own.component == component), 0)
        self._entries.append(_Entry(component, run_of(component), memory, watch, solution))
        return memory

    def visit(self, component: Any) -> None:
        """Record a run of a component; a run that does not follow the previous one begins a new solution."""
        solutions = next((own for own in self._solutions if own.component == component), None)
        if solutions is None:
            self._solutions = [own for own in self._solutions if own.component.OnPingDocument() is not None]
            self._solutions.append(solutions := _Solutions(component))
        run = run_of(component)
        solutions.number += run <= solutions.run
        solutions.run = run
        entry = self._entry(component)
        if entry is not None:
            entry.solution = solutions.number

    def has_unvisited(self, component: Any) -> bool:
        """Check whether some runs have not occurred in the current solution yet."""
        return bool(self._unvisited(component))

    def drop_unvisited(self, component: Any) -> None:
        """Drop the states of runs that did not occur in the last solution, as their branches are gone; call it between solutions."""
        for entry in self._unvisited(component):
            self._drop(entry)

    def all_of(self, component: Any) -> list[Memory]:
        """Return the states of all runs of a component."""
        return [entry.memory for entry in self._entries if entry.component == component]

    def earlier(self, component: Any) -> list[Memory]:
        """Return the states of the runs of a component before this one in the same solution."""
        return [entry.memory for entry in self._entries if entry.component == component and entry.run < run_of(component)]

    def drop(self, component: Any) -> None:
        """Drop the state of this run of a component."""
        entry = self._entry(component)
        if entry is not None:
            self._drop(entry)

    def drop_all(self, component: Any) -> None:
        """Drop the states of all runs of a component."""
        for entry in [entry for entry in self._entries if entry.component == component]:
            self._drop(entry)

    def _entry(self, component: Any) -> Optional[_Entry[Memory]]:
        run = run_of(component)
        # Rhino creates a new wrapper of an object on every access; wrappers are equal but not identical.
        return next((entry for entry in self._entries if entry.run == run and entry.component == component), None)

    def _unvisited(self, component: Any) -> list[_Entry[Memory]]:
        number = next((own.number for own in self._solutions if own.component == component), 0)
        return [entry for entry in self._entries if entry.component == component and entry.solution < number]

    def _drop(self, entry: _Entry[Memory]) -> None:
        self._entries = [other for other in self._entries if other is not entry]
        entry.unwatch()
        self._forget(entry.memory)


def run_of(component: Any) -> int:
    """Return the number of a run within its solution, from 1."""
    return int(getattr(component, "RunCount", 1))


def _when_closed(component: Any, callback: Callable[[], object]) -> Callable[[], object]:
    """Call a function when the document of a component is closed; scheduled callbacks do not run after that.

    Returns
    -------
    Callable
        Function that stops watching.
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
