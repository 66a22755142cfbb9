"""Curves to build along: lines of curvature, asymptotic nets and rulings."""

from __future__ import annotations

from .net import CurveNet
from .net import NetCurve
from .net import curve_net
from .net import plural

__all__ = ["CurveNet", "NetCurve", "curve_net", "plural"]
