"""Which layer means what, and how a designer's own layer names are mapped."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from dataclasses import fields
from pathlib import Path
from typing import Optional
from typing import Union

from ...errors import FileError

__all__ = ["RESULT", "LayerNames", "layer_names"]

RESULT = "CGC Result"


@dataclass(frozen=True)
class LayerNames:
    """The layers that are read, each with its sublayers; capitals do not matter.

    Parameters
    ----------
    mesh
        Meshes, joined to one.
    supports
        Points and point clouds at vertices that stay; curves along vertices that stay.
    creases
        Curves that the surface may fold along.
    targets
        Text dots, or points with user text, such as ``K=0.03`` in a region.
    constraints
        Curves that vertices shall stay on, or with user text ``keep`` stay at; points at the
        height that the vertex under or over them shall come to.
    """

    mesh: tuple[str, ...] = ("CGC::Mesh",)
    supports: tuple[str, ...] = ("CGC::Supports",)
    creases: tuple[str, ...] = ("CGC::Creases",)
    targets: tuple[str, ...] = ("CGC::Targets",)
    constraints: tuple[str, ...] = ("CGC::Constraints",)

    def role(self, layer: str) -> Optional[str]:
        """Return what a layer (its full path) means: a field of this class, ``"result"`` or None."""
        if _within(layer, RESULT):
            return "result"
        for field in fields(self):
            if any(_within(layer, name) for name in getattr(self, field.name)):
                return field.name
        return None


def layer_names(path: Union[str, os.PathLike, None] = None, given: Optional[Mapping[str, object]] = None) -> LayerNames:
    """Return the layer names for a file: the convention, changed by a TOML file beside it and by what is given.

    The TOML file has the name of the .3dm with the suffix ``.toml`` and a table such as::

        [layers]
        mesh = "Roof::Shell"
        supports = ["Columns", "Walls"]

    Parameters
    ----------
    path
        The .3dm file.
    given
        Names by role, as in the TOML table; they come before those of the TOML file.

    Raises
    ------
    FileError
        If the TOML file cannot be read, or names something else than roles and layers.
    """
    merged: dict[str, tuple[str, ...]] = {}
    beside = Path(path).with_suffix(".toml") if path is not None else None
    if beside is not None and beside.is_file():
        merged.update(_tuples(_toml(beside).get("layers", {}), str(beside)))
    merged.update(_tuples(given or {}, "the layer names"))
    return LayerNames(**merged)


def _within(layer: str, name: str) -> bool:
    layer, name = layer.casefold(), name.casefold()
    return layer == name or layer.startswith(name + "::")


def _toml(path: Path) -> dict:
    try:
        import tomllib
    except ImportError:  # Python 3.9 and 3.10
        import tomli as tomllib
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise FileError(f"{path} cannot be read as TOML: {error}") from None


def _tuples(names: object, source: str) -> dict[str, tuple[str, ...]]:
    roles = [field.name for field in fields(LayerNames)]
    if not isinstance(names, Mapping):
        raise FileError(f'{source}: [layers] must be a table such as mesh = "Roof"')
    result = {}
    for role, value in names.items():
        if role not in roles:
            raise FileError(f"{source}: there is no role {role!r} for a layer; use {', '.join(roles)}")
        values = [value] if isinstance(value, str) else value
        if not isinstance(values, (list, tuple)) or not all(isinstance(name, str) and name for name in values):
            raise FileError(f"{source}: {role} must be the name of a layer or a list of names, not {value!r}")
        result[role] = tuple(values)
    return result
