"""Solvers: a problem in, the surface with the curvature asked for out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .._lazy import attach
from .method import Method
from .registry import METHODS
from .registry import method_names
from .registry import options
from .registry import register
from .registry import settings_for
from .settings import AutoSettings
from .settings import Option
from .settings import Settings

if TYPE_CHECKING:
    from ..datastructures import SolveResult
    from .run import solve

__all__ = [
    "METHODS",
    "AutoSettings",
    "Method",
    "Option",
    "Settings",
    "SolveResult",
    "method_names",
    "options",
    "register",
    "settings_for",
    "solve",
]

__getattr__, __dir__ = attach(__name__, {"SolveResult": "..datastructures", "solve": ".run"})
