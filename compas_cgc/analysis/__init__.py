"""Analysis: how well a surface meets its targets, by more than one measure."""

from __future__ import annotations

from .quadric import quadric_curvatures
from .report import MeshQuality
from .report import RegionReport
from .report import SurfaceReport
from .report import analyse
from .verdict import Verdict
from .verdict import verdict

__all__ = ["MeshQuality", "RegionReport", "SurfaceReport", "Verdict", "analyse", "quadric_curvatures", "verdict"]
