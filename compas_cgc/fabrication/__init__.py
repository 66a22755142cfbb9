"""Fabrication: what a solved surface is built from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .._lazy import attach

if TYPE_CHECKING:
    from .development import Development
    from .development import develop
    from .development import lay_out
    from .materials import MATERIALS
    from .materials import Material
    from .mould_report import MouldReport
    from .moulding import moulds
    from .panelling import Panel
    from .panelling import panels

# Looked up when they are first used.
_HOMES = {
    "Development": ".development",
    "MATERIALS": ".materials",
    "Material": ".materials",
    "MouldReport": ".mould_report",
    "Panel": ".panelling",
    "develop": ".development",
    "lay_out": ".development",
    "moulds": ".moulding",
    "panels": ".panelling",
}

__all__ = [
    "MATERIALS",
    "Development",
    "Material",
    "MouldReport",
    "Panel",
    "develop",
    "lay_out",
    "moulds",
    "panels",
]

__getattr__, __dir__ = attach(__name__, _HOMES)
