"""Rationalisation: the surface nearest to a freeform design whose panels come off few moulds."""

from __future__ import annotations

from .._lazy import attach

# What is public is listed in __init__.pyi, for type checkers too.
__getattr__, __dir__, __all__ = attach(__name__, __file__)
