"""Surfaces of piecewise constant Gaussian curvature.

The input is a mesh with a target Gaussian curvature for each region; the result is the surface
with these curvatures. See :func:`compas_cgc.solve`.
"""

from __future__ import annotations

from pathlib import Path

from ._lazy import attach

__author__ = "The compas_cgc developers"
__copyright__ = "Copyright (c) 2026 The compas_cgc developers"
__license__ = "MIT License"

HERE = str(Path(__file__).resolve().parent)
"""Folder of the package."""

HOME = str(Path(HERE).parent)
"""Folder of the repository in a checkout, of the installed packages otherwise."""

DATA = str(Path(HERE) / "_sample_files")
"""Folder of the sample drawings, see :func:`get`."""

# Modules with COMPAS plugins.
__all_plugins__ = ["compas_cgc.scene", "compas_cgc.io.plugins"]

# What is public is listed in __init__.pyi, for type checkers too.
__getattr__, __dir__, __all__ = attach(__name__, __file__)
