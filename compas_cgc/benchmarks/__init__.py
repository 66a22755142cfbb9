"""Measurements as ratios within one run, so that they say the same on any machine."""

from __future__ import annotations

from .flow import example_times
from .flow import growth
from .kernels import kernel_ratio

__all__ = ["example_times", "growth", "kernel_ratio"]
