"""Lazy loading: names of a package that are looked up when they are first used, so that importing it costs nothing."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from collections.abc import Mapping
from importlib import import_module
from typing import Optional

__all__ = ["attach"]


def attach(
    package: str, homes: Mapping[str, str], renamed: Optional[Mapping[str, str]] = None
) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """Return ``__getattr__`` and ``__dir__`` of a package.

    Parameters
    ----------
    package
        Name of the package.
    homes
        Modules, relative to the package, that names live in.
    renamed
        New full names of what is still found here by an old one, with a warning.
    """
    moved = renamed or {}

    def look_up(name: str) -> object:
        if name in moved:
            warnings.warn(f"{package}.{name} is now {moved[name]}; the old name will go", DeprecationWarning, stacklevel=2)
            home, _, own = moved[name].rpartition(".")
            return getattr(import_module(home), own)
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(homes[name], package), name)

    return look_up, lambda: sorted({*homes, *vars(sys.modules[package])})
