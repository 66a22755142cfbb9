"""Fabrication: what a solved surface is built from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .._lazy import attach

if TYPE_CHECKING:
    from .assembly import draw_plan
    from .curves import CurveNet
    from .curves import curve_net
    from .cut_list import cut_list
    from .development import Development
    from .development import develop
    from .development import lay_out
    from .drawing import draw_sheets
    from .flattening import flatten
    from .flattening import widest_panel
    from .materials import MATERIALS
    from .materials import Material
    from .membrane_state import MembraneState
    from .membrane_state import membrane
    from .mould_report import MouldReport
    from .moulding import moulds
    from .panelling import Panel
    from .panelling import panels
    from .patterns import Patterns
    from .plane_layout import unfold
    from .unrolling import unroll

# Looked up when they are first used.
_HOMES = {
    "CurveNet": ".curves",
    "Development": ".development",
    "MATERIALS": ".materials",
    "Material": ".materials",
    "MembraneState": ".membrane_state",
    "MouldReport": ".mould_report",
    "Panel": ".panelling",
    "Patterns": ".patterns",
    "curve_net": ".curves",
    "cut_list": ".cut_list",
    "develop": ".development",
    "draw_plan": ".assembly",
    "draw_sheets": ".drawing",
    "flatten": ".flattening",
    "lay_out": ".development",
    "membrane": ".membrane_state",
    "moulds": ".moulding",
    "panels": ".panelling",
    "unfold": ".plane_layout",
    "unroll": ".unrolling",
    "widest_panel": ".flattening",
}

__all__ = [
    "MATERIALS",
    "CurveNet",
    "Development",
    "Material",
    "MembraneState",
    "MouldReport",
    "Panel",
    "Patterns",
    "curve_net",
    "cut_list",
    "develop",
    "draw_plan",
    "draw_sheets",
    "flatten",
    "lay_out",
    "membrane",
    "moulds",
    "panels",
    "unfold",
    "unroll",
    "widest_panel",
]

__getattr__, __dir__ = attach(__name__, _HOMES)
