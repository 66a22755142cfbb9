"""Reading and writing of `.3dm` files in double precision, without Rhino.

This package requires only rhino3dm; :mod:`compas_cgc.io.rhino.rhinocommon` is for code that
runs inside Rhino.
"""

from __future__ import annotations

from ..._lazy import attach

# What is public is listed in __init__.pyi, for type checkers too.
__getattr__, __dir__, __all__ = attach(__name__, __file__)
