"""Newton's method: one unknown per vertex, along its normal, to machine precision."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..._lazy import attach
from .method import METHOD
from .settings import NewtonSettings

if TYPE_CHECKING:
    from .normal_newton import newton

__all__ = ["METHOD", "NewtonSettings", "newton"]

__getattr__, __dir__ = attach(__name__, {"newton": ".normal_newton"})
