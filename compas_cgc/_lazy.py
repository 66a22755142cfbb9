"""Lazy loading: names of a package that are looked up when they are first used, so that importing it costs nothing."""

from __future__ import annotations

from collections.abc import Callable
from collections.abc import Mapping
from importlib import import_module

__all__ = ["attach"]


def attach(package: str, homes: Mapping[str, str]) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """Return ``__getattr__`` and ``__dir__`` of a package whose names live in modules given relative to it."""

    def look_up(name: str) -> object:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(homes[name], package), name)

    return look_up, lambda: sorted(homes)
