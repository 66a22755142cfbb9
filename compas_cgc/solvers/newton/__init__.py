"""Newton's method: one unknown per vertex, along its normal, to machine precision."""

from __future__ import annotations

from .newton import newton
from .settings import NewtonSettings

__all__ = ["NewtonSettings", "newton"]
