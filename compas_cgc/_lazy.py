"""Lazy loading: names of a package that are looked up when they are first used, so that importing it costs nothing."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from collections.abc import Iterator
from collections.abc import Mapping
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec

__all__ = ["attach"]


def attach(package: str, homes: Mapping[str, str]) -> tuple[Callable[[str], object], Callable[[], list[str]]]:
    """Return ``__getattr__`` and ``__dir__`` of a package.

    Parameters
    ----------
    package
        Name of the package.
    homes
        Modules, relative to the package, that names live in.
    """

    def look_up(name: str) -> object:
        if name not in homes and not name.startswith("_") and "." not in package and find_spec(f"{package}.{name}"):
            # Scripts need not import the parts of the package one by one.
            return import_module(f"{package}.{name}")
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}{_meant(package, name, homes)}")
        with _collecting_nothing():
            return getattr(import_module(homes[name], package), name)

    return look_up, lambda: sorted({*homes, *vars(sys.modules[package])})


@contextmanager
def _collecting_nothing() -> Iterator[None]:
    """Look for no garbage within a block: importing makes many objects that stay, and looking at them takes a tenth of its time."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


def _meant(package: str, name: str, homes: Mapping[str, str]) -> str:
    """Return the end of a sentence with the name that is most alike, if one is; tools that ask for ``_names`` are not told."""
    # The import system itself asks modules for ``__path__``, which those that are no packages do not have.
    if name.startswith("_"):
        return ""
    from pkgutil import iter_modules

    from .errors import did_you_mean

    parts = (part.name for part in iter_modules(vars(sys.modules[package]).get("__path__", [])) if part.ispkg)
    return did_you_mean(name, [*homes, *parts])
