"""Data trees: branches with paths, and their matching by the longest list."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Sequence
from typing import Any
from typing import NamedTuple
from typing import Optional

from .component_feedback import unwrapped
from .wires import is_tree

__all__ = ["Branch", "Match", "branches_of", "matched", "tree_at", "tree_of"]


class Branch(NamedTuple):
    """A branch of a data tree."""

    path: Any  # GH_Path; None for a value that arrived without a tree
    items: list[Any]  # null items are None


class Match(NamedTuple):
    """Matched items of one branch."""

    path: Any
    rows: list[tuple[Any, ...]]  # one item of each input per row


def branches_of(value: Any) -> list[Branch]:
    """Return the branches of a data tree; a value or a list becomes a single branch, None becomes none."""
    if value is None:
        return []
    if is_tree(value):
        return [Branch(path, [unwrapped(item) for item in value.Branch(path)]) for path in value.Paths]
    return [Branch(None, [unwrapped(item) for item in value] if isinstance(value, (list, tuple)) else [unwrapped(value)])]


def matched(*inputs: Sequence[Branch]) -> list[Match]:
    """Match data trees by Grasshopper's longest list.

    Branches are matched in their order, not by their paths. The last branch of a shorter tree, and the last item of a shorter branch,
    are used again. Null items keep their place. Paths are those of the first tree with the most branches.

    Parameters
    ----------
    inputs
        Branches of each input; None is used for an input without branches.
    """
    count = max(map(len, inputs), default=0)
    longest: Sequence[Branch] = next((own for own in inputs if len(own) == count), ())
    found = []
    for number in range(count):
        lists = [own[min(number, len(own) - 1)].items if own else [] for own in inputs]
        length = max(map(len, lists))
        rows = [tuple(items[min(row, len(items) - 1)] if items else None for items in lists) for row in range(length)]
        found.append(Match(longest[number].path, rows))
    return found


def tree_of(branches: Sequence[Iterable[Any]]) -> Any:
    """Return a data tree with the branches {0}, {1}, ...; None becomes a null item."""
    return tree_at([(None, number, values) for number, values in enumerate(branches)])


def tree_at(branches: Iterable[tuple[Any, Optional[int], Iterable[Any]]]) -> Any:
    """Return a data tree.

    Parameters
    ----------
    branches
        Path of each branch, {0} for None; index that is appended to the path, if any; items.
    """
    from Grasshopper import DataTree
    from Grasshopper.Kernel.Data import GH_Path
    from System import Object

    tree = DataTree[Object]()
    for path, index, values in branches:
        if path is None:
            path = GH_Path(index or 0)
        elif index is not None:
            path = path.AppendElement(index)
        tree.EnsurePath(path)
        for value in values:
            tree.Add(value, path)
    return tree
