"""Paths of files on wires."""

from __future__ import annotations

from pathlib import Path
from typing import Any

__all__ = ["file_path"]


def file_path(component: Any, text: str) -> str:
    """Return the path in a text, without quotes; relative paths begin in the folder of the definition, once it is saved."""
    path = Path(text.strip().strip("\"'")).expanduser()
    definition = getattr(component.OnPingDocument(), "FilePath", None)
    return str(path if path.is_absolute() or not definition else Path(str(definition)).parent / path)
