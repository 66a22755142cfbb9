"""Analysis of surfaces: curvature errors by several measures, quadric fits, NURBS fits."""

from __future__ import annotations

from ..model.verdict import Verdict
from ..model.verdict import verdict
from .quadric import quadric_curvatures
from .report import MeshQuality
from .report import RegionReport
from .report import SurfaceReport
from .report import analyse

__all__ = ["MeshQuality", "RegionReport", "SurfaceReport", "Verdict", "analyse", "quadric_curvatures", "verdict"]
