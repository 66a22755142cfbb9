"""Interface to OpenCASCADE; it imports little, for processes that start once per file."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from ..errors import FileError

__all__ = ["BSPLINE", "EDGE", "FACE", "SHELL", "opencascade"]

SHELL, FACE, EDGE = 3, 4, 6  # types of shapes
BSPLINE = 6  # type of the surface of a face


def opencascade() -> Any:
    """Return the interface to OpenCASCADE.

    Raises
    ------
    FileError
        If the package is not installed.
    """
    try:
        return import_module("compas_occt._occt")
    except ImportError:
        raise FileError("STEP files require the package compas_occt; install it with: pip install 'compas_cgc[cad]'") from None
