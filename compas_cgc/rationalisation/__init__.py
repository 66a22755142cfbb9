"""Rationalisation: the surface with panels from few moulds that is nearest to a freeform design."""

from __future__ import annotations

from .._lazy import attach

# What is public is listed in __init__.pyi, for type checkers too.
__getattr__, __dir__, __all__ = attach(__name__, __file__)
