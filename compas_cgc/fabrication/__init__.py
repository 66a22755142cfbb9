"""Fabrication of solved surfaces: panels, moulds, patterns, curve nets, membrane forces."""

from __future__ import annotations

from .._lazy import attach

# Public names are listed in __init__.pyi.
__getattr__, __dir__, __all__ = attach(__name__, __file__)
