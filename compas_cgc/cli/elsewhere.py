"""Surfaces that are not written to their places: those of unfinished searches, and those that cannot be."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from ..errors import CGCError

__all__ = ["save_elsewhere", "unfinished"]


def unfinished(path: Path) -> Path:
    """Return the path of an output of an unfinished search, which has a name of its own, so that it does not mix with others."""
    return path.with_name(f"{path.stem}.unfinished{path.suffix}")


def save_elsewhere(name: str, write: Callable[[Path], object]) -> None:
    """Write a surface to the folder for temporary files, so that a solve is not lost, and print where it is."""
    try:
        saved = Path(tempfile.mkdtemp(prefix="compas_cgc-")) / name
        write(saved)
        print(f"compas-cgc: saved the surface to {saved} instead", file=sys.stderr)
    except (CGCError, OSError) as error:
        print(f"compas-cgc: the surface cannot be saved elsewhere either ({error})", file=sys.stderr)
