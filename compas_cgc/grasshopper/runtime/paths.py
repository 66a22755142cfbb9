"""Paths of files on wires."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from typing import Optional

from ...errors import CGCError
from .memories import Memories

__all__ = ["file_path", "file_to_write"]

_FILES: Memories[str] = Memories(lambda file: None)


def file_path(component: Any, text: str) -> str:
    """Return the path in a text, without quotes; relative paths begin in the folder of the definition, once it is saved."""
    path = Path(text.strip().strip("\"'")).expanduser()
    definition = getattr(component.OnPingDocument(), "FilePath", None)
    return str(path if path.is_absolute() or not definition else Path(str(definition)).parent / path)


def file_to_write(component: Any, text: Optional[str], write: bool) -> Optional[str]:
    """Return the path in a text if `write` is true, for this run of a component.

    Raises
    ------
    CGCError
        If an earlier branch of the component writes the same file.
    """
    _FILES.drop(component)
    if not text or not write:
        return None
    file = file_path(component, text)
    if file in _FILES.earlier(component):
        raise CGCError(f"an earlier branch writes {file}; connect one path for each surface")
    return _FILES.keep(component, file)
