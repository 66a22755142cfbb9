"""Analysis: how well a surface meets its targets, by more than one measure."""

from __future__ import annotations

from ..model.verdict import Verdict
from ..model.verdict import verdict
from .quadric import quadric_curvatures
from .report import MeshQuality
from .report import RegionReport
from .report import SurfaceReport
from .report import analyse

__all__ = ["MeshQuality", "RegionReport", "SurfaceReport", "Verdict", "analyse", "quadric_curvatures", "verdict"]
