"""Plan, sections and elevations of a surface to scale, arranged on a sheet."""

from __future__ import annotations

from .layout import ViewSheet
from .layout import draw_views

__all__ = ["ViewSheet", "draw_views"]
