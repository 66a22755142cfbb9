"""Surfaces of piecewise constant Gaussian curvature.

A designer's mesh goes in; the surface with the Gaussian curvature asked for in each region
comes out. See :func:`compas_cgc.solve`.
"""

from __future__ import annotations

from ._lazy import attach

# COMPAS looks for plugins here.
__all_plugins__ = ["compas_cgc.scene", "compas_cgc.io.plugins"]

# What is public is listed in __init__.pyi, for type checkers too.
__getattr__, __dir__, __all__ = attach(__name__, __file__)
