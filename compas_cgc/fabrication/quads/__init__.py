"""Plane quads along lines of curvature where K > 0, and squares where H is constant: layout, planarisation, faces and beams."""

from __future__ import annotations

from .layout import plane_quads
from .plane_faces import PlaneQuads

__all__ = ["PlaneQuads", "plane_quads"]
