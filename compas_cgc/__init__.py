"""Surfaces of piecewise constant Gaussian curvature.

The input is a mesh with a target Gaussian curvature for each region; the result is the surface
with these curvatures. See :func:`compas_cgc.solve`.
"""

from __future__ import annotations

from ._lazy import attach

# Modules with COMPAS plugins.
__all_plugins__ = ["compas_cgc.scene", "compas_cgc.io.plugins"]

# What is public is listed in __init__.pyi, for type checkers too.
__getattr__, __dir__, __all__ = attach(__name__, __file__)
