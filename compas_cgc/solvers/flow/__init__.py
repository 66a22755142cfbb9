"""The paper's method: Gaussian curvature flow on surfaces, and its sketch on plane curves."""

from __future__ import annotations

from .curve import CurveResult
from .curve import curve_flow
from .flow import flow
from .settings import FlowSettings

__all__ = ["CurveResult", "FlowSettings", "curve_flow", "flow"]
