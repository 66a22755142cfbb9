"""Benchmarks as ratios within one run, which are comparable between machines."""

from __future__ import annotations

from .flow import example_times
from .flow import growth
from .kernels import kernel_ratio
from .server import server_overhead
from .solves import against_optimisers
from .solves import fairest_growth
from .solves import fitted_exponent
from .solves import interactive
from .solves import newton_growth

__all__ = [
    "against_optimisers",
    "example_times",
    "fairest_growth",
    "fitted_exponent",
    "growth",
    "interactive",
    "kernel_ratio",
    "newton_growth",
    "server_overhead",
]
