"""Moulds of the result of a job: options and computation in a worker."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...errors import CGCError
from ...errors import sentence_of
from ...fabrication.tasks import TASKS
from ...fabrication.tasks import build
from ...fabrication.tasks import read_settings
from ..errors import Unprocessable
from .mesh_files import KINDS
from .serialization import unpack_result

__all__ = ["MOULD_FORMATS", "MOULD_OPTIONS", "moulds_of", "read_mould_options"]

MOULD_FORMATS = {"json": "application/json", "3dm": KINDS["3dm"]}
# Query parameters are strings.
MOULD_OPTIONS: dict[str, dict] = {
    own.name: {**({"enum": ["true", "false"]} if own.schema.get("type") == "boolean" else own.schema), "description": own.text}
    for own in TASKS["mould"].options
}


def read_mould_options(query: Mapping[str, str]) -> dict[str, Any]:
    """Return the options in a query as numbers, strings and booleans.

    Raises
    ------
    Unprocessable
        If an option is unknown or invalid.
    """
    try:
        return read_settings("mould", {name: text for name, text in query.items() if name != "format"})
    except CGCError as error:
        raise Unprocessable(sentence_of(error)) from None


def moulds_of(content: bytes, options: dict[str, Any], kind: str) -> bytes:
    """Return the moulds of a packed result, as JSON or as a .3dm file.

    Raises
    ------
    Unprocessable
        If the moulds cannot be computed with these options.
    """
    problem = unpack_result(content)[0].problem
    try:
        report = build("mould", problem, options)
    except CGCError as error:
        raise Unprocessable(sentence_of(error)) from None
    if kind == "json":
        return json.dumps({**report.to_dict(), "text": str(report)}, ensure_ascii=False, allow_nan=False).encode("utf-8")
    from ...io.rhino import write_moulds

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "moulds.3dm"
        write_moulds(path, problem, report)
        return path.read_bytes()
