"""Moulds of the result of a job: what a client may ask, and the answer, made in a worker."""

from __future__ import annotations

import json
import math
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...errors import CGCError
from ..errors import Unprocessable
from .mesh_files import KINDS
from .serialization import unpack_result

__all__ = ["MOULD_FORMATS", "MOULD_OPTIONS", "moulds_of", "read_mould_options"]

MOULD_FORMATS = {"json": "application/json", "3dm": KINDS["3dm"]}
MOULD_OPTIONS: dict[str, dict] = {
    "size": {"type": "number", "exclusiveMinimum": 0, "description": "width of the panels, nearly [L]"},
    "count": {
        "type": "integer",
        "minimum": 1,
        "maximum": 1_000_000,
        "description": "panels to a region, instead of size; 1 without either",
    },
    "along": {"enum": ["plan", "curvature"]},
    "material": {"type": "string", "description": "glass, steel, gfrp or timber"},
    "thickness": {"type": "number", "exclusiveMinimum": 0, "description": "of the panels [mm]"},
    "tolerance": {"type": "number", "minimum": 0, "description": "gap up to which panels of different K share a mould [mm]"},
    "rough": {"enum": ["true", "false"], "description": "take a surface that its verdict calls rough all the same"},
}
_NUMBERS = ("size", "thickness", "tolerance")


def read_mould_options(query: Mapping[str, str]) -> dict[str, Any]:
    """Return the options in a query, as numbers, texts and truths.

    Raises
    ------
    Unprocessable
        With a sentence that names the option.
    """
    found: dict[str, Any] = {}
    for name, text in query.items():
        if name == "format":
            continue
        if name not in MOULD_OPTIONS:
            raise Unprocessable(f"there is no option {name!r:.60}; there are {', '.join(MOULD_OPTIONS)}")
        if name in _NUMBERS or name == "count":
            found[name] = _number(name, text)
        elif name == "rough":
            if text not in ("true", "false"):
                raise Unprocessable(f"'rough' must be true or false, not {text!r:.60}")
            found[name] = text == "true"
        else:
            found[name] = text
    if "size" not in found and "count" not in found:
        found["count"] = 1
    return found


def _number(name: str, text: str) -> float:
    try:
        value = int(text) if name == "count" else float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and 0 <= value <= 1e9):
        raise Unprocessable(f"'{name}' must be a {'whole ' if name == 'count' else ''}number from 0 to 1e9, not {text!r:.60}")
    return value


def moulds_of(content: bytes, options: dict[str, Any], kind: str) -> bytes:
    """Return the moulds of a packed result, as JSON or as a .3dm file.

    Raises
    ------
    Unprocessable
        With the sentence of whoever refuses.
    """
    from ...fabrication import moulds
    from ...fabrication import panels

    problem = unpack_result(content)[0].problem
    try:
        divided = panels(problem, options.get("size"), count=options.get("count"), along=options.get("along", "plan"))
        chosen = {name: options[name] for name in ("material", "thickness", "tolerance", "rough") if name in options}
        report = moulds(problem, divided, **chosen)
    except CGCError as error:
        raise Unprocessable(str(error)) from None
    if kind == "json":
        return json.dumps({**report.to_dict(), "text": str(report)}, ensure_ascii=False, allow_nan=False).encode("utf-8")
    from ...io.rhino import write_moulds

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "moulds.3dm"
        write_moulds(path, problem, report)
        return path.read_bytes()
