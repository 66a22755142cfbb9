"""Data trees with one branch per region."""

from __future__ import annotations

from collections.abc import Iterable
from collections.abc import Sequence
from typing import Any

__all__ = ["tree_of"]


def tree_of(branches: Sequence[Iterable[Any]]) -> Any:
    """Return a data tree with the branches {0}, {1}, ...; None becomes a null item."""
    from Grasshopper import DataTree
    from Grasshopper.Kernel.Data import GH_Path
    from System import Object

    tree = DataTree[Object]()
    for number, values in enumerate(branches):
        path = GH_Path(number)
        tree.EnsurePath(path)
        for value in values:
            tree.Add(value, path)
    return tree
