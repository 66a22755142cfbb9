"""The paper's method: Gaussian curvature flow on surfaces, and its sketch on plane curves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..._lazy import attach
from .method import METHOD
from .settings import FlowSettings

if TYPE_CHECKING:
    from .curve import CurveResult
    from .curve import curve_flow
    from .gradient_flow import flow

__all__ = ["METHOD", "CurveResult", "FlowSettings", "curve_flow", "flow"]

__getattr__, __dir__ = attach(__name__, {"CurveResult": ".curve", "curve_flow": ".curve", "flow": ".gradient_flow"})
