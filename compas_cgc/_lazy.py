"""Lazy loading: names of a package are imported when first used, to keep the import of the package fast."""

from __future__ import annotations

import ast
import gc
import sys
from collections.abc import Callable
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

__all__ = ["attach"]


def attach(package: str, file: str) -> tuple[Callable[[str], object], Callable[[], list[str]], list[str]]:
    """Return ``__getattr__``, ``__dir__`` and ``__all__`` of a package, from the imports in its type stub.

    Parameters
    ----------
    package
        Name of the package.
    file
        Path of its ``__init__.py``; the stub ``__init__.pyi`` is in the same folder.
    """
    homes = _imports(Path(file).with_suffix(".pyi"))
    top = "." not in package

    def subpackages() -> list[str]:
        from pkgutil import iter_modules

        found = iter_modules([str(Path(file).parent)]) if top else ()
        return [part.name for part in found if part.ispkg and not part.name.startswith("_")]

    def look_up(name: str) -> object:
        if name in homes:
            with _garbage_collector_off():
                return getattr(import_module(homes[name], package), name)
        # The import system and other tools request private names such as ``__path__``, which most modules lack.
        if name.startswith("_"):
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        if top and find_spec(f"{package}.{name}"):
            return import_module(f"{package}.{name}")

        from .errors import did_you_mean

        raise AttributeError(f"module {package!r} has no attribute {name!r}{did_you_mean(name, [*homes, *subpackages()])}")

    def listed() -> list[str]:
        # COMPAS looks for ``__all_plugins__`` in this list.
        special = [name for name in ("__all_plugins__",) if name in vars(sys.modules[package])]
        return sorted([*homes, *subpackages(), *special])

    return look_up, listed, sorted(homes)


def _imports(stub: Path) -> dict[str, str]:
    """Return the module, relative to the package, of every name imported in a stub."""
    body = ast.parse(stub.read_text(encoding="utf-8")).body
    imports = (own for own in body if isinstance(own, ast.ImportFrom))
    return {alias.name: "." * own.level + (own.module or "") for own in imports for alias in own.names}


@contextmanager
def _garbage_collector_off() -> Iterator[None]:
    """Disable the garbage collector within a block; it takes a tenth of the time of an import."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()
