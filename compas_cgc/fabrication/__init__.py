"""Fabrication: what a solved surface is built from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .._lazy import attach

if TYPE_CHECKING:
    from .development import Development
    from .development import develop
    from .development import lay_out

# Looked up when they are first used.
_HOMES = {
    "Development": ".development",
    "develop": ".development",
    "lay_out": ".development",
}

__all__ = ["Development", "develop", "lay_out"]

__getattr__, __dir__ = attach(__name__, _HOMES)
