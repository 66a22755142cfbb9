"""Analysis: how well a surface meets its targets, by more than one measure."""

from __future__ import annotations

from .quadric import quadric_curvatures
from .report import MeshQuality
from .report import RegionReport
from .report import SurfaceReport
from .report import analyse

__all__ = ["MeshQuality", "RegionReport", "SurfaceReport", "analyse", "quadric_curvatures"]
