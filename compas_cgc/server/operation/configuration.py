"""Configuration file of a server."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from typing import Optional
from typing import Union
from typing import get_type_hints

from ...errors import CGCError
from ...errors import nearest_name
from ..limits import Limits
from .logs import FORMATS

__all__ = ["read_configuration"]

# Options of the file by their type; those of PATHS are relative to the file.
OPTIONS: dict[str, type] = {
    "executor": str,
    "host": str,
    "keys": str,
    "limits": dict,
    "log": str,
    "names": list,
    "port": int,
    "prefix": str,
    "store": str,
    "trusted_proxy": str,
    "workers": int,
}
PATHS = ("keys", "store")
TYPES = {str: "text", int: "a whole number", list: "a list of texts", dict: "a table"}
MAY_BE_ZERO = ("free", "remembered", "reserved")


def read_configuration(path: Union[str, Path]) -> dict[str, Any]:
    """Read the configuration of a server.

    Parameters
    ----------
    path
        A .toml file with the options of ``compas-cgc serve`` (``host``, ``port``, ``keys``, ``store``, ``names``, ``workers``,
        ``executor``, ``trusted_proxy``, ``prefix``, ``log``) and a table ``[limits]`` with fields of
        :class:`~compas_cgc.server.Limits`.

    Returns
    -------
    dict
        Options by name; ``limits`` is a :class:`~compas_cgc.server.Limits`, and paths are absolute.

    Raises
    ------
    CGCError
        If the file cannot be read, or an option is unknown or invalid.
    """
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        import tomli as tomllib
    try:
        found = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError, RecursionError) as error:
        raise CGCError(f"the configuration {path} cannot be read ({error})") from None
    _check_names(path, found, OPTIONS, "option")
    for name, value in found.items():
        kind = OPTIONS[name]
        texts = not isinstance(value, list) or all(isinstance(text, str) for text in value)
        if not isinstance(value, kind) or isinstance(value, bool) or not texts:
            raise CGCError(f"{path}: {name} must be {TYPES[kind]}, not {value!r:.60}")
    for name, low, high in (("port", 0, 65535), ("workers", 1, 10_000)):
        if not low <= found.get(name, low) <= high:
            raise CGCError(f"{path}: {name} must be from {low} to {high}, not {found[name]}")
    if found.get("log", "text") not in FORMATS:
        raise CGCError(f"{path}: log must be {' or '.join(FORMATS)}, not {found['log']!r:.60}")
    folder = Path(path).resolve().parent
    read = {name: str(folder / Path(value).expanduser()) if name in PATHS else value for name, value in found.items()}
    return {**read, "limits": _limits(path, found.get("limits", {}))}


def _limits(path: Union[str, Path], found: Mapping[str, Any]) -> Limits:
    hints = get_type_hints(Limits)
    fields = {name: hints[name] for name in Limits.__dataclass_fields__}
    _check_names(path, found, fields, "limit")
    for name, value in found.items():
        whole = fields[name] is int
        kinds = (int,) if whole else (int, float)
        low = 0 if name in MAY_BE_ZERO else 1 if whole else 0.0
        if not isinstance(value, kinds) or isinstance(value, bool) or not math.isfinite(value) or value < low or (not whole and value == 0):
            what = f"a whole number from {low} up" if whole else "a number greater than 0"
            raise CGCError(f"{path}: the limit {name} must be {what}, not {value!r:.60}")
    return Limits(**found)


def _check_names(path: Union[str, Path], found: Mapping[str, Any], known: Mapping[str, Any], what: str) -> None:
    for name in found:
        if name not in known:
            near: Optional[str] = nearest_name(name, known)
            hint = f"the {what}s are {', '.join(known)}" if near is None else f"did you mean {near}?"
            raise CGCError(f"{path}: unknown {what} {name!r:.60}; {hint}")
